#pragma once

// Values of the command line that replace values of a scenario's files.

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "sim/environment/environment_model.hpp"

namespace proleg::sim {

/// The words of the options, as the user wrote them.
struct OverrideWords {
  std::optional<std::string> seed;
  std::optional<std::string> friction;
  std::optional<std::string> at;
  std::optional<std::string> heading;
};

struct Overrides {
  std::optional<std::uint64_t> seed;
  /// Coefficient of every geometry of the environment, also of those without one. The robot's links keep theirs.
  std::optional<double> friction;
  std::optional<Eigen::Vector2d> at;  ///< m, x and y of the start pose
  std::optional<double> height;       ///< m, z of the start pose; only with `at`
  /// Turns the start pose about the vertical through its position, to the left.
  std::optional<double> heading_deg;
};

/// Throws InputError with the option as its file.
[[nodiscard]] Overrides read_overrides(const OverrideWords& words);

/// Gives every geometry of the environment this coefficient.
void set_friction(EnvironmentModel& environment, double friction);

/// Applies friction and start pose. The start pose is the one of the file, before the robot is lifted onto the ground.
void apply_overrides(const Overrides& overrides, EnvironmentModel& environment);

/// "X,Y" or "X,Y,Z" as read_overrides reads it; nothing without `at`.
[[nodiscard]] std::optional<std::string> position_text(const Overrides& overrides);

}  // namespace proleg::sim
