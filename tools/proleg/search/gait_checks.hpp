#pragma once

// How the best gaits of an experiment do in other worlds: whether a search found a gait, or the accidents of one world.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/confirm/perturbed_worlds.hpp"
#include "sim/optimize/experiment/fitness.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

/// A gait of an experiment: the best of a method, or a reference.
struct NamedGait {
  std::string name;
  sim::Scenario scenario;
};

/// How far a gait goes in the judging engine, in m.
struct CheckedGait {
  std::string name;
  double distance_m = 0.0;  ///< in its own world
  optimize::WorldDistances worlds;
  double level_m = 0.0;  ///< on level ground, in the same time
};

inline constexpr std::uint32_t checked_worlds = 20;

/// A gait keeps the level if its distance on level ground differs from the plain gait's by at most this share. One that
/// goes farther has a reflex that makes the gait larger, also where nothing is in the way.
inline constexpr double level_tolerance = 0.15;

/// The user has interrupted a check (tools/proleg/common/interrupt.hpp).
class CheckInterrupted {};

/// How far a scenario's robot comes, in m, in the scenario's engine; NaN if the physics failed. distance: what the
/// searches rate, in m. Throws CheckInterrupted.
[[nodiscard]] double gait_distance(const sim::Scenario& scenario, const optimize::Objective& distance);

/// Runs a gait in its own world, in worlds that differ (friction and masses by a tenth, start by 5 mm), and on level
/// ground. level: the environment without the obstacle. distance: as above. Throws CheckInterrupted.
[[nodiscard]] CheckedGait check_gait(NamedGait gait, const sim::EnvironmentModel& level,
                                     const optimize::Objective& distance);

/// A table, a line for each gait; the last column compares the distance on level ground with that of the first gait.
/// Below it, what "level kept" in the name of a gait means.
[[nodiscard]] std::string gait_checks_text(const std::vector<CheckedGait>& gaits);
[[nodiscard]] Json gait_checks_json(const std::vector<CheckedGait>& gaits);

/// The four stages of figure 6.8 in a run of the scenario: the robot's middle on the second hill, in the pit behind it,
/// at its end, and on the last hill. Fewer if the robot does not get there. Throws CheckInterrupted.
[[nodiscard]] std::vector<optimize::CrossingStage> crossing_stages(sim::Scenario scenario);

}  // namespace proleg::tools
