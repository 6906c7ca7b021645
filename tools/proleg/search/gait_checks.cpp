#include "tools/proleg/search/gait_checks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/output/output.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using optimize::CrossingStage;

/// Variation by a tenth of friction and masses, and by 5 mm, as if the thesis's robot were placed by hand.
constexpr optimize::WorldVariation variation{.spread = {.friction = 0.1, .mass = 0.1}, .start_m = 0.005};
constexpr std::uint64_t worlds_seed = 1;

void stop_if_interrupted() {
  if (interrupted()) {
    throw CheckInterrupted();
  }
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? NAN : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  if (values.size() < 2) {
    return NAN;
  }
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double lowest(const std::vector<double>& values) { return values.empty() ? NAN : values.front(); }
double highest(const std::vector<double>& values) { return values.empty() ? NAN : values.back(); }

/// Middle of the links' origins along y.
double middle_of(const sim::Plant& plant) {
  double sum = 0.0;
  for (const sim::Pose& pose : plant.link_poses()) {
    sum += pose.position.y();
  }
  return sum / static_cast<double>(plant.link_poses().size());
}

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

double gait_distance(const sim::Scenario& scenario, const optimize::Objective& distance) {
  try {
    sim::Simulation simulation(scenario);
    simulation.leave_out_hashes();
    while (simulation.tick() < sim::tick_count(scenario)) {
      simulation.advance();
      stop_if_interrupted();
    }
    return distance.score(simulation.plant().meter().values());
  } catch (const sim::PhysicsError&) {
    return NAN;
  }
}

CheckedGait check_gait(NamedGait gait, const sim::EnvironmentModel& level, const optimize::Objective& distance) {
  sim::Scenario& scenario = gait.scenario;
  scenario.environment.engine = optimize::judging_engine;
  CheckedGait checked{std::move(gait.name), gait_distance(scenario, distance), {}, 0.0};
  checked.worlds = optimize::distances_in_worlds(
      scenario, checked_worlds, worlds_seed, variation, [](double) { stop_if_interrupted(); },
      [&](const sim::Plant& plant) { return distance.score(plant.meter().values()); });
  scenario.environment = level;
  scenario.environment.engine = optimize::judging_engine;
  checked.level_m = gait_distance(scenario, distance);
  return checked;
}

std::string gait_checks_text(const std::vector<CheckedGait>& gaits) {
  std::string text = "the best gaits in " + std::to_string(checked_worlds) +
                     " worlds (friction and masses by a tenth, start by 5 mm), and on level ground:\n";
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "%-33s%10s%10s%9s%10s%10s%10s%11s\n", "gait", "own (m)", "mean (m)", "sd (m)",
                "lowest", "highest", "level (m)", "to plain");
  text += line.data();
  for (const CheckedGait& gait : gaits) {
    const std::vector<double>& worlds = gait.worlds.distances;
    const double to_plain = 100.0 * (gait.level_m / gaits.front().level_m - 1.0);
    std::snprintf(line.data(), line.size(), "%-33s%10.3f%10.3f%9.3f%10.3f%10.3f%10.3f%+9.1f %%\n", gait.name.c_str(),
                  gait.distance_m, mean_of(worlds), deviation_of(worlds), lowest(worlds), highest(worlds), gait.level_m,
                  to_plain);
    text += line.data();
    if (gait.worlds.failed > 0) {
      text += "  " + std::to_string(gait.worlds.failed) + " worlds without a distance\n";
    }
  }
  const int percent = static_cast<int>(std::lround(100.0 * level_tolerance));
  text += "level kept: the farthest gait of a method that on level ground is within " + std::to_string(percent) +
          " % of the first one; farther there,\nthe reflex makes the gait larger where nothing is in the way\n";
  return text;
}

Json gait_checks_json(const std::vector<CheckedGait>& gaits) {
  Json list = Json::empty_array();
  for (const CheckedGait& gait : gaits) {
    list.append({{"name", gait.name},
                 {"distance_m", gait.distance_m},
                 {"worlds_m", gait.worlds.distances},
                 {"worlds_failed", gait.worlds.failed},
                 {"level_m", gait.level_m}});
  }
  return list;
}

std::vector<CrossingStage> crossing_stages(sim::Scenario scenario) {
  struct Place {
    const char* name;
    double share;  ///< share of the obstacle
  };
  constexpr std::array<Place, 4> places{
      {{"on the second hill", 0.375}, {"in the pit", 0.625}, {"leaving the pit", 0.75}, {"on the last hill", 0.875}}};
  scenario.environment.engine = optimize::judging_engine;
  const optimize::ObstacleExtent extent = optimize::obstacle_extent(scenario.environment);
  std::vector<CrossingStage> stages;
  try {
    sim::Simulation simulation(scenario);
    simulation.leave_out_hashes();
    while (simulation.tick() < sim::tick_count(scenario) && stages.size() < places.size()) {
      simulation.advance();
      stop_if_interrupted();
      const Place& next = places[stages.size()];
      if (middle_of(simulation.plant()) >= extent.from + next.share * (extent.to - extent.from)) {
        const auto poses = simulation.plant().link_poses();
        const auto contacts = simulation.latched_contacts();
        stages.push_back(
            {next.name, simulation.time_s(), {poses.begin(), poses.end()}, {contacts.begin(), contacts.end()}});
      }
    }
  } catch (const sim::PhysicsError&) {
    return stages;  // only the stages before the failure
  }
  return stages;
}

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
