#pragma once

// Checks the gaits of an experiment of the thesis, those without a search and the best of each method, in other worlds:
// whether a search found a gait, or the accidents of one world.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/confirm/gait_confirmation.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/optimize/report/thesis_experiment.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/search/experiment_methods.hpp"

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

/// Thrown if the user has interrupted a check.
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

/// The figures of check_gaits().
inline constexpr std::array<std::string_view, 2> gait_check_figures{"figure_6_8.svg", "figure_7_3.svg"};

[[nodiscard]] std::vector<optimize::Reference> reference_distances(const optimize::ThesisExperiment& thesis,
                                                                   const optimize::Experiment& experiment,
                                                                   const std::filesystem::path& scenarios);

/// Checks the references on the obstacle, the best of each method, and its best that keeps the level, if it has one:
/// each in its own world, in other worlds and on level ground. Writes figures 6.8, the crossing of the best, and 7.3,
/// all distances on a ruler, to the folder, and the gaits that keep the level to those of the methods. results: one for
/// each chosen method. The experiment must have a level ground. Throws CheckInterrupted.
[[nodiscard]] std::vector<CheckedGait> check_gaits(const optimize::ThesisExperiment& thesis,
                                                   const std::vector<ChosenMethod>& chosen,
                                                   const std::vector<MethodResult>& results,
                                                   const std::filesystem::path& scenarios,
                                                   const std::filesystem::path& folder);

}  // namespace proleg::tools
