// The module proleg._search: searches whose candidates are rated in Python. It is a module of its own because pagmo
// takes a tenth of a second to load.

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/measure/measure.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment_form.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/search/optimise.hpp"
#include "tools/python/module/asked_search.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"
#include "tools/python/module/worker_threads.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

using optimize::Experiment;
using Words = std::map<std::string, std::string>;  ///< of options, by their names

std::optional<std::string> word(const Words& words, const char* name) {
  const auto found = words.find(name);
  return found == words.end() ? std::nullopt : std::optional(found->second);
}

tools::OptimiseOptions options_of(const Words& words) {
  tools::OptimiseOptions options;
  options.file = word(words, "file");
  options.simulation = word(words, "simulation");
  options.engine = word(words, "engine");
  options.trials = word(words, "trials");
  options.evaluations = word(words, "evaluations");
  options.seed = word(words, "seed");
  (options.file ? options.out : options.resume) = word(words, "store");
  return options;
}

/// The section of an experiment file, and in it the algorithm, of a method by its short name.
std::pair<std::string, std::string> section_of(const std::string& method) {
  std::map<std::string, std::string> sections{{"great-deluge", "greatDeluge"}, {"genetic", "geneticAlgorithm"}};
  std::vector<std::string> names{"great-deluge", "genetic"};
  for (const optimize::PagmoDeclaration& pagmo : optimize::pagmo_declarations()) {
    names.emplace_back(pagmo.name);
    sections.emplace(pagmo.name, "pagmo");
  }
  sections.insert_or_assign("cmaes", "cmaEs");
  sections.insert_or_assign("de", "differentialEvolution");
  sections.insert_or_assign("nsga2", "nsga2");
  const auto found = sections.find(method);
  if (found == sections.end()) {
    throw InputError("method", 0, in_quotes(method), "one of " + listed(names));
  }
  return {found->second, found->second == "pagmo" ? method : ""};
}

/// The experiment with another method: its file is written anew, as the page does it, so that its store has all that is
/// needed to go on. Settings that both methods have stay.
Experiment with_method(const Experiment& experiment, const std::string& method) {
  sim::SourceTexts files;
  for (const sim::SourceFile& source : experiment.sources) {
    files.add(source.path, source.text);
  }
  optimize::ExperimentForm form = optimize::read_experiment_form(experiment.path, files, experiment.scenario);
  std::tie(form.method, form.algorithm) = section_of(method);
  const auto declaration = std::ranges::find_if(optimize::methods(), [&](const optimize::MethodDeclaration& each) {
    return each.tag == form.method && each.algorithm == form.algorithm;
  });
  std::erase_if(form.settings, [&](const auto& setting) {
    return declaration != optimize::methods().end() &&
           std::ranges::find(declaration->settings, setting.first, &optimize::MethodSetting::tag) ==
               declaration->settings.end();
  });
  const optimize::ExperimentText text = optimize::experiment_text(form, experiment.scenario, experiment.scenario.path);
  sim::SourceTexts changed;
  for (const sim::SourceFile& source : experiment.sources) {
    changed.add(source.path, source.path == experiment.path ? sim::SharedText(text.text) : source.text);
  }
  return optimize::read_experiment(experiment.path, changed, experiment.scenario.path);
}

Experiment read(const Words& words) {
  const tools::OptimiseOptions options = options_of(words);
  Experiment experiment = tools::read_experiment(options);
  if (const auto method = word(words, "method")) {
    experiment = with_method(experiment, *method);
    tools::apply_options(options, experiment);
  }
  return experiment;
}

/// Measures of the terms of all objectives, each once.
std::vector<std::string> needed_measures(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const optimize::Objective& objective : experiment.objectives) {
    for (const optimize::Term& term : objective.terms) {
      const std::string name(sim::declaration_of(term.measure).name);
      if (std::ranges::find(names, name) == names.end()) {
        names.push_back(name);
      }
    }
  }
  return names;
}

class Search {
 public:
  Search(const Words& words, std::optional<std::uint32_t> at_once) {
    Experiment experiment = read(words);
    const auto store = word(words, "store");
    folder_ = tools::chosen_folder(store, std::nullopt, experiment.title(), "search");
    std::optional<std::uint32_t> trials;
    if (word(words, "trials")) {
      trials = experiment.trials.count;
    }
    search_ = std::make_unique<AskedSearch>(std::move(experiment), folder_, trials, at_once);
    wait();
  }
  ~Search() {
    if (getpid() != process_) {
      static_cast<void>(search_.release());  // the thread and the lock of its store are the parent's
    }
  }
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  /// The rows that are to be rated: values, numbers of their evaluations, and trials.
  py::tuple ask(std::size_t most) {
    require_process();
    const OneThread use(is_used_, "Search");
    wait();
    asked_ = search_->tasks(most);
    asked_at_ = std::chrono::steady_clock::now();
    const optimize::SearchSpace& space = experiment().space;
    std::vector<double> values;
    std::vector<std::int64_t> numbers;
    std::vector<std::int64_t> trials;
    for (const optimize::Task& task : asked_) {
      for (std::size_t d = 0; d < space.dimensions.size(); ++d) {
        values.push_back(space.value(task.candidate, d));
      }
      numbers.push_back(static_cast<std::int64_t>(task.number));
      trials.push_back(task.trial);
    }
    const std::size_t rows = asked_.size();
    return py::make_tuple(array_of(std::move(values), {rows, space.dimensions.size()}),
                          array_of(std::move(numbers), {rows}), array_of(std::move(trials), {rows}));
  }

  /// The measures of the rows of the last ask(). failures: by row why there are none, or empty.
  void tell(const py::array_t<double, py::array::c_style | py::array::forcecast>& values,
            const std::vector<std::string>& names, const std::vector<std::string>& failures) {
    require_process();
    const OneThread use(is_used_, "Search");
    std::vector<sim::Measure> measures;
    for (const std::string& name : names) {
      const auto measure = sim::find_measure(name);
      if (!measure) {
        throw InputError("measures", 0, in_quotes(name), "one of " + listed(sim::measure_names()));
      }
      measures.push_back(*measure);
    }
    for (const std::string& name : needed_measures(experiment())) {
      if (std::ranges::find(names, name) == names.end()) {
        throw InputError("measures", 0, listed(names), "also " + name + ", which the search needs");
      }
    }
    require_asked("tell");
    if (values.ndim() != 2 || static_cast<std::size_t>(values.shape(0)) != asked_.size() ||
        static_cast<std::size_t>(values.shape(1)) != names.size() || failures.size() != asked_.size()) {
      throw InputError("tell", 0, "an array of another shape", "a row for each candidate of ask()");
    }
    const std::chrono::duration<double> needed = std::chrono::steady_clock::now() - asked_at_;
    std::vector<optimize::TrialResult> results(asked_.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
      for (std::size_t m = 0; m < measures.size(); ++m) {
        const double value = values.at(i, m) + 0.0;  // no -0: stores do not keep the sign
        results[i].measures[measures[m]] = std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value;
      }
      results[i].failure = failures[i];
      results[i].wall_s = needed.count() / static_cast<double>(results.size());
    }
    answer(std::move(results));
  }

  /// Rates what is asked for as `proleg optimise` does. Returns the number of runs.
  std::size_t simulate(std::size_t most, std::size_t workers) {
    require_process();
    const OneThread use(is_used_, "Search");
    wait();
    asked_ = search_->tasks(most);
    if (asked_.empty()) {
      return 0;
    }
    std::vector<optimize::TrialResult> results(asked_.size());
    {
      const Unlocked unlocked;
      WorkerThreads threads(experiment().scenario, asked_.size(), workers,
                            [&](std::size_t first, std::size_t end, const std::atomic<bool>& /*stop*/) {
                              std::vector<optimize::TrialResult> some =
                                  optimize::run_trials(experiment(), std::span(asked_).subspan(first, end - first));
                              std::ranges::move(some, results.begin() + static_cast<std::ptrdiff_t>(first));
                            });
      threads.wait();
    }
    const std::size_t count = results.size();
    require_asked("simulate");
    answer(std::move(results));
    return count;
  }

  void close() {
    if (getpid() == process_) {
      const OneThread use(is_used_, "Search");
      const Unlocked unlocked;
      search_->close();
    }
  }

  [[nodiscard]] bool is_done() const { return search_->has_ended(); }
  [[nodiscard]] std::optional<std::string> ending() const { return search_->ending(); }

  /// The best evaluation by the first objective: number, values and scores; None if none has a score.
  [[nodiscard]] py::object best() const {
    const std::optional<optimize::Evaluation> best = search_->progress().best;
    if (!best) {
      return py::none();
    }
    py::dict values;
    const optimize::SearchSpace& space = experiment().space;
    for (std::size_t d = 0; d < space.dimensions.size(); ++d) {
      values[py::str(space.dimensions[d].name)] = space.value(best->candidate, d);
    }
    py::dict scores;
    for (std::size_t i = 0; i < best->scores.size(); ++i) {
      scores[py::str(experiment().objectives[i].name)] = best->scores[i];
    }
    return py::make_tuple(best->number, values, scores);
  }

  /// Columns by the names that the store has for them.
  [[nodiscard]] py::dict table() const {
    const std::vector<optimize::Evaluation> evaluations = search_->evaluations();
    const std::size_t rows = evaluations.size();
    py::dict table;
    const auto add = [&](const std::string& name, const auto& of) {
      std::vector<double> column;
      column.reserve(rows);
      for (const optimize::Evaluation& evaluation : evaluations) {
        column.push_back(of(evaluation));
      }
      table[py::str(name)] = array_of(std::move(column), {rows});
    };
    std::vector<std::int64_t> numbers;
    std::vector<std::uint8_t> reused;
    py::list failures;
    for (const optimize::Evaluation& evaluation : evaluations) {
      numbers.push_back(static_cast<std::int64_t>(evaluation.number));
      reused.push_back(evaluation.reused ? 1 : 0);
      failures.append(evaluation.failure);
    }
    table["number"] = array_of(std::move(numbers), {rows});
    const optimize::StoreColumns columns(experiment());
    for (std::size_t i = 0; i < columns.scores.size(); ++i) {
      add(columns.scores[i], [i](const optimize::Evaluation& evaluation) { return evaluation.scores[i]; });
    }
    for (std::size_t d = 0; d < columns.values.size(); ++d) {
      add(columns.values[d], [this, d](const optimize::Evaluation& evaluation) {
        return experiment().space.value(evaluation.candidate, d);
      });
    }
    for (std::size_t m = 0; m < columns.measures.size(); ++m) {
      add(columns.measures[m], [m](const optimize::Evaluation& evaluation) { return evaluation.measures.all()[m]; });
    }
    table["reused"] = array_of(std::move(reused), {rows}).attr("view")("?");
    table["failure"] = failures;
    return table;
  }

  /// Of each dimension: its name, its unit, and its values in ascending order.
  [[nodiscard]] py::list dimensions() const {
    py::list all;
    const optimize::SearchSpace& space = experiment().space;
    optimize::Candidate candidate(space.dimensions.size(), 0);
    for (std::size_t d = 0; d < space.dimensions.size(); ++d) {
      const std::size_t count = space.dimensions[d].values.size();
      std::vector<double> values;
      for (candidate[d] = 0; candidate[d] < count; ++candidate[d]) {
        values.push_back(space.value(candidate, d));
      }
      candidate[d] = 0;
      all.append(py::make_tuple(space.dimensions[d].name, sim::shown_unit(space.dimensions[d].unit),
                                array_of(std::move(values), {count})));
    }
    return all;
  }

  /// Of each objective: its name, its unit, and whether more is better.
  [[nodiscard]] py::list objectives() const {
    py::list all;
    for (const optimize::Objective& objective : experiment().objectives) {
      all.append(
          py::make_tuple(objective.name, std::string(objective.unit()), objective.goal == optimize::Goal::maximise));
    }
    return all;
  }

  [[nodiscard]] std::vector<std::string> measures() const { return needed_measures(experiment()); }
  [[nodiscard]] const Experiment& experiment() const { return search_->experiment(); }
  [[nodiscard]] const std::string& remark() const { return search_->remark(); }
  [[nodiscard]] std::string folder() const { return folder_.string(); }

 private:
  void require_process() const {
    if (getpid() != process_) {
      throw InputError("Search", 0, "a call in a process that was forked", "the process that opened the search");
    }
  }

  /// Until the method asks for something or has ended.
  void wait() {
    const Unlocked unlocked;
    SignalWatch watch;
    while (!search_->wait_until_asked(std::chrono::milliseconds(50))) {
      watch.check();
    }
  }

  void require_asked(const char* call) const {
    if (search_->has_ended()) {
      const std::string why = search_->ending().value_or("it was closed, or 'proleg optimise --stop' stopped it");
      throw InputError(call, 0, "a search that has ended: " + why, "one that goes on");
    }
    if (asked_.empty()) {
      throw InputError(call, 0, "scores of no candidates", "ask() before each tell()");
    }
  }

  void answer(std::vector<optimize::TrialResult> results) {
    asked_.clear();
    search_->answer(std::move(results));
    wait();
  }

  const pid_t process_ = getpid();
  bool is_used_ = false;
  std::filesystem::path folder_;
  std::unique_ptr<AskedSearch> search_;
  std::vector<optimize::Task> asked_;  ///< rows of the last ask() that have no result
  std::chrono::steady_clock::time_point asked_at_;
};

}  // namespace
}  // namespace proleg::python

namespace pybind11::detail {
template <>
class type_caster<proleg::python::Search> : public caster_of_made<proleg::python::Search> {};
}  // namespace pybind11::detail

PYBIND11_MODULE(_search, module) {
  using proleg::python::Search;
  proleg::python::share_with_core(module);
  py::class_<Search>(module, "Search")
      .def(py::init<const proleg::python::Words&, std::optional<std::uint32_t>>(), py::arg("words"), py::arg("at_once"))
      .def("ask", &Search::ask, py::arg("most"))
      .def("tell", &Search::tell, py::arg("values"), py::arg("measures"), py::arg("failures"))
      .def("simulate", &Search::simulate, py::arg("most"), py::arg("workers"))
      .def("close", &Search::close)
      .def_property_readonly("done", &Search::is_done)
      .def_property_readonly("ending", &Search::ending)
      .def_property_readonly("best", &Search::best)
      .def("table", &Search::table)
      .def_property_readonly("dimensions", &Search::dimensions)
      .def_property_readonly("objectives", &Search::objectives)
      .def_property_readonly("measures", &Search::measures)
      .def_property_readonly("folder", &Search::folder)
      .def_property_readonly("remark", &Search::remark)
      .def_property_readonly(
          "method", [](const Search& search) { return proleg::optimize::method_name(search.experiment().method); })
      .def_property_readonly("seed", [](const Search& search) { return search.experiment().seed; })
      .def_property_readonly("evaluations", [](const Search& search) { return search.experiment().evaluations; })
      .def_property_readonly("scenario", [](const Search& search) { return search.experiment().scenario; });
  proleg::python::refuse_copies(module.attr("Search"));
}
