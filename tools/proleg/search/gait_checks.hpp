#pragma once

// Checks the best gaits of an experiment in other worlds: whether a search found a gait, or the accidents of one world.

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

/// The distances of a gait in the judging engine, in m.
struct CheckedGait {
  std::string name;
  double distance_m = 0.0;  ///< distance in its own world
  optimize::WorldDistances worlds;
  double level_m = 0.0;  ///< distance on level ground, in the same time
};

inline constexpr std::uint32_t checked_worlds = 20;

/// A gait keeps the level if its distance on level ground differs from the plain gait's by at most this share. A gait
/// that goes farther has a reflex that makes it larger, also without an obstacle.
inline constexpr double level_tolerance = 0.15;

/// The user has interrupted a check (tools/proleg/common/interrupt.hpp).
class CheckInterrupted {};

/// Distance of a scenario's robot in m, in the scenario's engine; NaN if the physics failed. distance: the objective of
/// the searches, in m. Throws CheckInterrupted.
[[nodiscard]] double gait_distance(const sim::Scenario& scenario, const optimize::Objective& distance);

/// Runs a gait in its own world, in worlds that differ (friction and masses by a tenth, start by 5 mm), and on level
/// ground. level: the environment without the obstacle. distance: the objective of the searches. Throws
/// CheckInterrupted.
[[nodiscard]] CheckedGait check_gait(NamedGait gait, const sim::EnvironmentModel& level,
                                     const optimize::Objective& distance);

/// A table with a line for each gait; the last column compares the distance on level ground with that of the first
/// gait. A text below it explains "level kept" in the name of a gait.
[[nodiscard]] std::string gait_checks_text(const std::vector<CheckedGait>& gaits);
[[nodiscard]] Json gait_checks_json(const std::vector<CheckedGait>& gaits);

/// The four stages of figure 6.8 in a run of the scenario: the robot's middle on the second hill, in the pit behind it,
/// at its end, and on the last hill. They are fewer if the robot does not get there. Throws CheckInterrupted.
[[nodiscard]] std::vector<optimize::CrossingStage> crossing_stages(sim::Scenario scenario);

}  // namespace proleg::tools
