#include "tools/proleg/search/gait_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/common/interrupt.hpp"

namespace proleg::tools {
namespace {

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

}  // namespace proleg::tools
