#include "tools/proleg/search/repetitions.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/worker_pool.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/interrupt.hpp"
#include "tools/proleg/search/optimisation.hpp"
#include "tools/proleg/search/side_by_side.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

using optimize::Evaluation;
using optimize::Experiment;
using optimize::Store;

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
