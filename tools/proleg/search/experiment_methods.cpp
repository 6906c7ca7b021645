#include "tools/proleg/search/experiment_methods.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/worker_pool.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/search/optimisation.hpp"
#include "tools/proleg/search/search_result.hpp"
#include "tools/proleg/search/side_by_side.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using optimize::Evaluation;
using optimize::Experiment;
using optimize::Store;

/// The methods of the experiment, and the other algorithms of pagmo that search for one objective.
std::vector<ExperimentMethod> all_methods(const optimize::ThesisExperiment& thesis) {
  std::vector<ExperimentMethod> methods;
  for (const optimize::ThesisMethod& method : thesis.methods) {
    methods.push_back({std::string(method.name), std::string(method.file), std::string(method.table),
                       std::string(method.runs_figure), std::string(method.spread_figure)});
  }
  for (const optimize::PagmoAlgorithm& algorithm : optimize::pagmo_algorithms()) {
    const std::string name(algorithm.name);
    if (algorithm.declaration().objectives != optimize::ObjectiveCount::several && name != "cmaes") {
      methods.push_back({name, "cma_es.optimise.xml", "table_" + name + ".tsv", "figure_" + name + "_runs.svg",
                         "figure_" + name + "_spread.svg", false});
    }
  }
  return methods;
}

/// Throws InputError unless a method has the name.
void check_method_name(const std::vector<ExperimentMethod>& methods, const std::string& name) {
  if (std::ranges::count(methods, name, &ExperimentMethod::name) == 0) {
    std::vector<std::string> names;
    std::ranges::transform(methods, std::back_inserter(names), &ExperimentMethod::name);
    throw InputError("--method", 0, in_quotes(name), "one of " + listed(names));
  }
}

optimize::Experiment experiment_of(const MethodChoice& choice, const ExperimentMethod& method) {
  sim::DiskFiles files;
  optimize::Experiment experiment = optimize::read_experiment(choice.scenarios / method.file, files);
  if (!method.shipped) {
    optimize::PagmoSettings settings;
    settings.algorithm = method.name;
    experiment.method = settings;
  }
  experiment.has_baseline = false;  // the thesis's searches have no baseline; the references are in the summary
  apply_options(choice.options, experiment);
  return experiment;
}

/// Whether the store in a folder has all repetitions of this experiment. Its method is then part of the comparison,
/// even if the user did not name it.
bool is_complete(const optimize::Experiment& experiment, std::uint32_t repetitions, const fs::path& folder) {
  try {
    optimize::Store store(store_path(folder), experiment, result_key, optimize::Store::Opening::resume);
    for (std::uint32_t run = 0; run < repetitions; ++run) {
      if (!has_ended(store, experiment, run)) {
        return false;
      }
    }
    return true;
  } catch (const optimize::StoreError&) {
    return false;  // the folder has no store, or one of another experiment
  }
}

/// A search that has ended, with its best evaluation, which is rated again if the experiment is judged.
struct Repetition {
  SearchOutcome outcome;
  Evaluation winner;
};

class Repetitions {
 public:
  Repetitions(std::string name, const Experiment& experiment, std::uint32_t count, fs::path folder)
      : name_(std::move(name)), experiment_(experiment), count_(count), folder_(std::move(folder)) {}

  /// The runs that have not ended. Takes over the results that processes of an earlier program left.
  [[nodiscard]] std::vector<std::uint32_t> unfinished() const {
    const std::unique_ptr<Store> store = open();
    add_parts(*store);
    std::vector<std::uint32_t> runs;
    for (std::uint32_t run = 0; run < count_; ++run) {
      if (!has_ended(*store, experiment_, run)) {
        runs.push_back(run);
      }
    }
    return runs;
  }

  /// Runs searches, each in a process with a store of its own, which then becomes part of the experiment's store.
  void search_side_by_side(std::uint32_t worker_count, std::span<const std::uint32_t> runs) const {
    for (const std::uint32_t run : runs) {
      open_store(part(run), experiment_, Store::Opening::fresh)->add(store_path(folder_), run);
    }
    const auto at_once = static_cast<std::uint32_t>(
        std::min(runs.size(), optimize::WorkerPool::useful_searches(experiment_, worker_count)));
    optimize::WorkerPool pool(experiment_, worker_count, at_once);
    const auto work = [&](std::uint32_t process, const NextNumber& next) {
      const std::unique_ptr<optimize::Workers> workers = pool.workers_of(process);
      while (const std::optional<std::uint32_t> run = next()) {
        const std::unique_ptr<Store> store = open_store(part(*run), experiment_, Store::Opening::resume);
        static_cast<void>(search(*run, *workers, *store, std::cout));
      }
    };
    work_side_by_side(at_once, runs, work, [&] { pool.leave_to_searches(); });
  }

  [[nodiscard]] MethodResult collect(std::uint32_t worker_count) const {
    optimize::LocalWorkers workers(experiment_, worker_count);
    const std::unique_ptr<Store> store = open();
    add_parts(*store);
    MethodResult result{{name_, experiment_.space, {}}, {}, {}};
    if (const auto engine = experiment_.scenario.environment.engine; engine != optimize::judging_engine) {
      result.runs.engine = sim::name_of(engine);
    }
    for (std::uint32_t run = 0; run < count_ && !interrupted(); ++run) {
      std::optional<Repetition> repetition = search(run, workers, *store, std::cerr);
      if (!repetition) {
        break;
      }
      if (!result.best ||
          experiment_.objectives.front().better(repetition->winner.scores.front(), result.best->scores.front())) {
        result.best = repetition->winner;
      }
      result.endings.push_back(repetition->outcome.ending);
      if (optimize::is_judged(experiment_)) {
        result.runs.judged.push_back(repetition->winner);
      }
      result.runs.runs.push_back(std::move(repetition->outcome.evaluations));
    }
    return result;
  }

 private:
  [[nodiscard]] std::unique_ptr<Store> open() const {
    const bool exists = fs::exists(store_path(folder_));
    return open_store(folder_, experiment_, exists ? Store::Opening::resume : Store::Opening::fresh);
  }

  [[nodiscard]] fs::path part(std::uint32_t run) const { return folder_ / ("part" + std::to_string(run)); }

  void add_parts(Store& store) const {
    for (std::uint32_t run = 0; run < max_repetitions; ++run) {
      if (fs::exists(store_path(part(run)))) {
        try {
          store.add(store_path(part(run)));
        } catch (const optimize::StoreError& refused) {
          throw BadInput(refused.what());
        }
      }
      fs::remove_all(part(run));
    }
  }

  /// Runs a search; nothing if the user interrupts. Prints a line if it has simulated a candidate.
  [[nodiscard]] std::optional<Repetition> search(std::uint32_t run, optimize::Workers& workers, Store& store,
                                                 std::ostream& out) const {
    const std::string label = name_ + " " + std::to_string(run + 1) + "/" + std::to_string(count_);
    Repetition result{run_search(experiment_, run, workers, store, label), {}};
    SearchOutcome& outcome = result.outcome;
    if (outcome.ending.empty()) {
      return std::nullopt;
    }
    if (!outcome.progress.best) {
      throw std::runtime_error(name_ + ": none of " + std::to_string(outcome.evaluations.size()) +
                               " evaluations has a score; the first failure: " + outcome.progress.first_failure);
    }
    result.winner = *outcome.progress.best;
    if (optimize::is_judged(experiment_)) {
      const std::vector<optimize::Confirmation> confirmations = confirm_best(experiment_, workers, store, outcome);
      if (confirmations.empty()) {
        return std::nullopt;
      }
      result.winner = confirmations.front().evaluation;
      result.winner.scores.front() = confirmations.front().mean;
    } else if (optimize::needs_confirmation(experiment_)) {
      store.finish_run(run, outcome.ending);  // the experiments of the thesis have no fresh runs
    }
    if (outcome.progress.simulated > 0) {
      out << name_ << " " << run + 1 << " of " << count_ << ": " << outcome.evaluations.size() << " evaluations, best "
          << result.winner.scores.front() << " " << experiment_.objectives.front().unit() << ", " << outcome.ending
          << "; " << outcome.progress.simulated << " simulated in "
          << static_cast<long>(outcome.wall_s + outcome.confirmation_wall_s) << " s" << std::endl;
    }
    return result;
  }

  std::string name_;
  const Experiment& experiment_;
  std::uint32_t count_;
  fs::path folder_;
};

}  // namespace

const optimize::ThesisExperiment& find_experiment(const std::string& name) {
  std::vector<std::string> names;
  for (const optimize::ThesisExperiment* experiment : optimize::thesis_experiments()) {
    if (experiment->name == name) {
      return *experiment;
    }
    names.push_back(in_quotes(experiment->name));
  }
  throw InputError(name, 0, "unknown experiment " + in_quotes(name), listed(names));
}

fs::path find_experiment_files(const optimize::ThesisExperiment& thesis, const std::optional<std::string>& given) {
  const std::string name(thesis.name);
  const std::string file(thesis.methods.front().file);
  const fs::path inside = fs::path("sim") / "scenarios" / name;
  std::vector<fs::path> candidates;
  if (given) {
    candidates.emplace_back(*given);
  } else {
    candidates.push_back(inside);
    if (const std::optional<fs::path> shipped = shipped_folder()) {
      candidates.push_back(*shipped / name);
    }
  }
  for (const fs::path& folder : candidates) {
    if (fs::is_regular_file(folder / file)) {
      return folder;
    }
  }
  throw InputError(given ? "--scenarios" : name, 0, "no " + (candidates.front() / file).string(),
                   "the experiment's files; give their folder with --scenarios");
}

std::vector<ChosenMethod> choose_methods(const optimize::ThesisExperiment& thesis, const MethodChoice& choice) {
  const std::vector<ExperimentMethod> methods = all_methods(thesis);
  for (const std::string& name : choice.names) {
    check_method_name(methods, name);
  }
  std::vector<ChosenMethod> chosen;
  for (const ExperimentMethod& method : methods) {
    const bool is_asked_for = choice.names.empty() ? method.shipped : std::ranges::count(choice.names, method.name) > 0;
    const fs::path folder = choice.folder / method.name;
    if (!is_asked_for && !fs::exists(store_path(folder))) {
      continue;
    }
    optimize::Experiment experiment = experiment_of(choice, method);
    if (is_asked_for || is_complete(experiment, choice.repetitions, folder)) {
      refuse_overwriting(experiment, folder);
      if (!fs::exists(store_path(folder))) {
        check_result_folder(folder, search_result_files);
      }
      chosen.push_back({method, std::move(experiment)});
    }
  }
  return chosen;
}

MethodResult run_repetitions(const std::string& name, const Experiment& experiment, std::uint32_t repetitions,
                             std::uint32_t workers, const fs::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  const Repetitions all(name, experiment, repetitions, folder);
  const std::vector<std::uint32_t> unfinished = all.unfinished();
  // Fewer searches than workers would not keep them busy. (An engine with batches divides a search's share.)
  if (unfinished.size() > 1 && unfinished.size() * optimize::WorkerPool::tasks_of_worker(experiment) >= workers) {
    all.search_side_by_side(workers, unfinished);
  }
  MethodResult result = all.collect(workers);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace proleg::tools
