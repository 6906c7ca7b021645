#pragma once

// Values of the command line that replace values of a scenario's files.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "sim/environment/environment_model.hpp"

namespace proleg::sim {

/// The words of the options, as the user wrote them.
struct OverrideWords {
  std::optional<std::string> engine;
  std::optional<std::string> seed;
  std::optional<std::string> friction;
  std::optional<std::string> at;
  std::optional<std::string> heading;
};

/// An option that replaces a value.
struct OverrideDeclaration {
  std::string_view name;  ///< without "--"
  std::optional<std::string> OverrideWords::*word;
  bool of_simulated_world;  ///< without a meaning for a real robot
  std::string_view help;
};
[[nodiscard]] std::span<const OverrideDeclaration> override_declarations();

struct Overrides {
  std::optional<PhysicsEngine> engine;
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

/// The words that give the same overrides.
[[nodiscard]] OverrideWords words_of(const Overrides& overrides);

/// Gives every geometry of the environment this coefficient.
void set_friction(EnvironmentModel& environment, double friction);

/// Applies engine, friction and start pose. The start pose is the one of the file, before the robot is lifted onto the
/// ground.
void apply_overrides(const Overrides& overrides, EnvironmentModel& environment);

}  // namespace proleg::sim
