#include "tools/proleg/search/experiment_gaits.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/output/output.hpp"
#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/terminal_line.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// A scenario of the experiment that has no search, in the engine of the searches.
sim::Scenario reference_scenario(const optimize::ReferenceScenario& reference, const optimize::Experiment& experiment,
                                 const fs::path& folder) {
  if (reference.file.empty()) {
    return experiment.scenario;
  }
  sim::DiskFiles files;
  sim::Scenario scenario = sim::read_scenario(folder / reference.file, files);
  scenario.environment.engine = experiment.scenario.environment.engine;
  return scenario;
}

/// The scenario with the best values that a method has found.
sim::Scenario best_scenario(const optimize::Experiment& experiment, const MethodResult& result) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(result.best->candidate, scenario);
  return scenario;
}

/// The check of an experiment's gaits on level ground.
class LevelGround {
 public:
  LevelGround(const optimize::ThesisExperiment& thesis, const optimize::Experiment& experiment,
              const fs::path& scenarios)
      : distance_(experiment.objectives.front()) {
    const auto level = std::ranges::find(thesis.references, thesis.level_ground, &optimize::ReferenceScenario::file);
    plain_ = reference_scenario(*level, experiment, scenarios);
  }
  [[nodiscard]] const sim::EnvironmentModel& environment() const { return plain_.environment; }
  /// Whether the scenario's gait goes about as far on level ground as the plain one, in an engine.
  [[nodiscard]] bool is_kept_by(sim::Scenario scenario, sim::PhysicsEngine engine) {
    const double plain = plain_distance(engine);
    scenario.environment = plain_.environment;
    scenario.environment.engine = engine;
    return std::abs(gait_distance(scenario, distance_) - plain) <= level_tolerance * plain;
  }

 private:
  double plain_distance(sim::PhysicsEngine engine) {
    const auto [known, is_new] = plain_m_.try_emplace(engine);
    if (is_new) {
      sim::Scenario scenario = plain_;
      scenario.environment.engine = engine;
      known->second = gait_distance(scenario, distance_);
    }
    return known->second;
  }

  const optimize::Objective& distance_;
  sim::Scenario plain_;
  std::map<sim::PhysicsEngine, double> plain_m_;
};

/// Shows the user the progress; each gait takes half a minute.
class CheckProgress {
 public:
  void begin_gait(const std::string& name) { begin("checks " + name + " in other worlds"); }
  void begin_search(const std::string& method) { begin("looks for a gait of " + method + " that keeps the level"); }
  void show_search(std::size_t done, std::size_t all) {
    if (line_.is_due()) {
      line_.draw(text_ + ": " + std::to_string(done) + " of at most " + std::to_string(all) + " candidates");
    }
  }

 private:
  void begin(std::string text) {
    text_ = std::move(text);
    if (line_.is_visible()) {
      line_.draw(text_);
    } else {
      std::cerr << text_ + "\n";
    }
  }

  TerminalLine line_{std::chrono::milliseconds(0)};
  std::string text_;
};

/// The gait of a method that keeps the level and goes farthest in the judging engine.
std::optional<optimize::Evaluation> best_that_keeps(LevelGround& level, const optimize::Experiment& experiment,
                                                    const MethodResult& result, CheckProgress& progress) {
  constexpr std::size_t most_of_a_repetition = 200;
  constexpr std::size_t most_judged = 5;
  const optimize::Objective& distance = experiment.objectives.front();
  std::vector<optimize::Evaluation> candidates;
  for (const std::vector<optimize::Evaluation>& run : result.runs.runs) {
    std::ranges::move(optimize::best_candidates(experiment, run, most_of_a_repetition), std::back_inserter(candidates));
  }
  std::ranges::stable_sort(
      candidates, [&](double left, double right) { return distance.better(left, right); },
      [](const optimize::Evaluation& evaluation) { return evaluation.scores.front(); });
  std::optional<optimize::Evaluation> best;
  std::size_t judged = 0;
  for (std::size_t i = 0; i < candidates.size() && judged < most_judged; ++i) {
    progress.show_search(i, candidates.size());
    optimize::Evaluation& candidate = candidates[i];
    const sim::Scenario own = optimize::own_world(experiment, candidate);
    // The gait is checked first in the engine of the search, if that is the faster one.
    if ((optimize::is_judged(experiment) && !level.is_kept_by(own, experiment.scenario.environment.engine)) ||
        !level.is_kept_by(own, optimize::judging_engine)) {
      continue;
    }
    ++judged;
    candidate.scores.front() = gait_distance(own, distance);
    if (!best || distance.better(candidate.scores.front(), best->scores.front())) {
      best = candidate;
    }
  }
  return best;
}

}  // namespace

std::vector<optimize::Reference> reference_distances(const optimize::ThesisExperiment& thesis,
                                                     const optimize::Experiment& experiment,
                                                     const fs::path& scenarios) {
  std::vector<optimize::Reference> references;
  for (const optimize::ReferenceScenario& reference : thesis.references) {
    optimize::Experiment without_search = experiment;
    without_search.scenario = reference_scenario(reference, experiment, scenarios);
    without_search.space.dimensions.clear();
    optimize::Task task;
    const optimize::Objective& distance = experiment.objectives.front();
    const double searched = distance.score(optimize::run_trial(without_search, task).measures);
    double judged = searched;
    if (optimize::is_judged(experiment)) {
      task.trial = experiment.trials.count;
      judged = distance.score(optimize::run_trial(without_search, task).measures);
    }
    references.push_back({&reference, searched, judged});
  }
  return references;
}

std::vector<CheckedGait> check_gaits(const optimize::ThesisExperiment& thesis, const std::vector<ChosenMethod>& chosen,
                                     const std::vector<MethodResult>& results, const fs::path& scenarios,
                                     const fs::path& folder) {
  const optimize::Experiment& first = chosen.front().experiment;
  LevelGround level(thesis, first, scenarios);
  CheckProgress progress;
  std::vector<CheckedGait> checks;
  const auto check = [&](const std::string& name, sim::Scenario scenario) {
    progress.begin_gait(name);
    checks.push_back(check_gait({name, std::move(scenario)}, level.environment(), first.objectives.front()));
  };
  for (const optimize::ReferenceScenario& reference : thesis.references) {
    if (reference.file != thesis.level_ground) {
      check(std::string(reference.short_name), reference_scenario(reference, first, scenarios));
    }
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& [method, experiment] = chosen[i];
    const MethodResult& result = results[i];
    check(result.runs.method, best_scenario(experiment, result));
    progress.begin_search(result.runs.method);
    if (const std::optional<optimize::Evaluation> kept = best_that_keeps(level, experiment, result, progress)) {
      const std::string name = result.runs.method + ", level kept";
      if (kept->candidate == result.best->candidate) {
        checks.push_back(checks.back());
        checks.back().name = name;
      } else {
        check(name, optimize::own_world(experiment, *kept));
      }
      optimize::write_scenario(experiment, *kept, folder / method.name, "level_kept");
    }
  }
  std::vector<optimize::RulerMark> marks;
  marks.reserve(checks.size());
  for (const CheckedGait& gait : checks) {
    marks.push_back({gait.name, gait.distance_m});
  }
  const auto score = [](const MethodResult& result) { return result.best->scores.front(); };
  const auto farthest = std::ranges::max_element(results, {}, score);
  const sim::Scenario best =
      best_scenario(chosen[static_cast<std::size_t>(farthest - results.begin())].experiment, *farthest);
  write_file(folder / gait_check_figures[0], optimize::draw_crossing(best, crossing_stages(best)));
  write_file(folder / gait_check_figures[1], optimize::draw_distances(best, marks));
  return checks;
}

}  // namespace proleg::tools
