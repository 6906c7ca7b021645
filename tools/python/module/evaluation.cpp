#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "sim/optimize/evaluation/scenario_runs.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"
#include "tools/python/module/worker_threads.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

/// Candidates, row by row, and their scores.
class Evaluation {
 public:
  Evaluation(const sim::Scenario& scenario, std::vector<std::string> names, std::vector<double> candidates,
             std::vector<sim::Measure> measures)
      : scenario_(scenario),
        names_(std::move(names)),
        candidates_(std::move(candidates)),
        measures_(std::move(measures)),
        count_(candidates_.size() / names_.size()),
        scores_(count_ * measures_.size(), std::numeric_limits<double>::quiet_NaN()),
        failures_(count_) {}

  [[nodiscard]] std::size_t count() const { return count_; }

  /// Throws InputError for the first value that its parameter does not take; the message names its place.
  void check() const {
    sim::Scenario scenario = scenario_;
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < names_.size(); ++k) {
        try {
          sim::apply_setting(scenario, word(i, k));
        } catch (const InputError& error) {
          throw InputError("candidates[" + std::to_string(i) + ", " + std::to_string(k) + "]: " + error.what());
        }
      }
    }
  }

  /// Simulates some candidates, in the thread that calls. stop: ends the work.
  void run(std::size_t first, std::size_t end, const std::atomic<bool>& stop) {
    std::vector<sim::Scenario> scenarios(end - first, scenario_);
    for (std::size_t i = first; i < end; ++i) {
      for (std::size_t k = 0; k < names_.size(); ++k) {
        sim::apply_setting(scenarios[i - first], word(i, k));
      }
    }
    const auto after_tick = [&stop](std::size_t /*i*/, const sim::Simulation& /*simulation*/,
                                    optimize::TrialResult& result) { result.given_up = stop; };
    const auto at_end = [&](std::size_t i, const sim::Simulation& simulation, optimize::TrialResult& /*result*/) {
      const sim::MeasureValues values = simulation.measures();
      for (std::size_t m = 0; m < measures_.size(); ++m) {
        scores_[(first + i) * measures_.size() + m] = values[measures_[m]];
      }
    };
    std::vector<optimize::TrialResult> results = optimize::run_scenarios(scenarios, {after_tick, at_end});
    for (std::size_t i = first; i < end; ++i) {
      failures_[i] = std::move(results[i - first].failure);
    }
  }

  [[nodiscard]] std::vector<double> take_scores() { return std::move(scores_); }
  [[nodiscard]] std::vector<std::string> take_failures() { return std::move(failures_); }

 private:
  [[nodiscard]] std::string word(std::size_t candidate, std::size_t name) const {
    return names_[name] + '=' + word_of(candidates_[candidate * names_.size() + name]);
  }

  const sim::Scenario& scenario_;
  std::vector<std::string> names_;
  std::vector<double> candidates_;
  std::vector<sim::Measure> measures_;
  std::size_t count_;
  std::vector<double> scores_;
  std::vector<std::string> failures_;
};

/// Throws InputError if a parameter has no effect, because a later one of the row takes its place.
void require_effect(const sim::Scenario& scenario, const std::vector<std::string>& names) {
  std::vector<sim::SettingTarget> targets;
  for (const std::string& name : names) {
    const sim::SettingTarget target = sim::find_named_target(scenario, name);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (targets[i].same_value(target) && (targets[i].joints & target.joints) == targets[i].joints) {
        throw InputError("names", 0, in_quotes(names[i]) + " and " + in_quotes(name) + " for the same joints",
                         "each parameter once; one of a single joint after that of all");
      }
    }
    targets.push_back(target);
  }
}

sim::Measure measure_named(const std::string& name) {
  const std::optional<sim::Measure> measure = sim::find_measure(name);
  if (!measure) {
    throw InputError("measure", 0, in_quotes(name), "one of " + listed(sim::measure_names()));
  }
  return *measure;
}

py::tuple evaluate(sim::Scenario scenario, const std::vector<std::string>& names,
                   const py::array_t<double, py::array::c_style | py::array::forcecast>& candidates,
                   const std::vector<std::string>& measure_names, std::size_t workers) {
  if (names.empty() || candidates.ndim() != 2 || static_cast<std::size_t>(candidates.shape(1)) != names.size() ||
      measure_names.empty() || workers == 0) {
    throw InputError("evaluate", 0, "arguments of other shapes", "those that the package gives");
  }
  require_effect(scenario, names);
  static_cast<void>(tools::run_ticks(scenario));  // refuses changes after the end
  std::vector<sim::Measure> measures;
  std::ranges::transform(measure_names, std::back_inserter(measures), measure_named);
  const auto count = static_cast<std::size_t>(candidates.shape(0));
  Evaluation evaluation(scenario, names, std::vector<double>(candidates.data(), candidates.data() + candidates.size()),
                        measures);
  evaluation.check();
  if (count > 0) {
    const Unlocked unlocked;
    WorkerThreads threads(
        scenario, count, workers,
        [&](std::size_t first, std::size_t end, const std::atomic<bool>& stop) { evaluation.run(first, end, stop); });
    threads.wait();
  }
  return py::make_tuple(array_of(evaluation.take_scores(), {count, measures.size()}), evaluation.take_failures());
}

}  // namespace

void add_evaluation(py::module_& module) {
  module.def("evaluate", &evaluate, py::arg("scenario"), py::arg("names"), py::arg("candidates"), py::arg("measures"),
             py::arg("workers"));
}

}  // namespace proleg::python
