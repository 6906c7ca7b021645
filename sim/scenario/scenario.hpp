#pragma once

// The contents of a *.simulation.xml file and of the files that it names, checked: every Scenario can be run.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/computer/change/change.hpp"
#include "shared/kernel/kernel.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "sim/environment/environment_model.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/shared_text.hpp"

namespace proleg::sim {

enum class Solver : std::uint8_t {
  automatic,  ///< direct up to 8 links, iterative above
  direct,     ///< exact and repeatable on every thread
  iterative,  ///< approximate, in time proportional to the number of links
};

/// A file as it was read, kept for the recording.
struct SourceFile {
  std::string path;
  SharedText text;
};

/// The robot is put elsewhere, as a hand does it: at a tick, as a rigid body, and at rest.
struct RobotMove {
  std::uint32_t tick = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, of the head's frame, after the move
  double turn_deg = 0.0;                               ///< about the vertical through the head's frame, to the left
};

struct Scenario {
  std::string path;
  RobotModel robot;
  EnvironmentModel environment;

  KernelConfiguration kernel;
  std::vector<AngleLimits> joint_limits;  ///< of set-points, within +-90 degrees; kernel order, one for each joint
  std::vector<ModulePlace> modules;       ///< kernel order, one for each joint, no node id twice
  std::optional<RobotControlEntry> robot_control;  ///< plug-in of a robot without modules; no effect in a simulation
  std::vector<Setting> settings;                   ///< start values that differ from the defaults
  std::vector<Change> changes;                     ///< while the robot moves, by ascending tick
  std::vector<RobotMove> moves;                    ///< by ascending tick; those of a tick in their order

  double duration_s = 30.0;
  double step_s = 0.001;  ///< of the physics; a tick is a whole number of steps
  Solver solver = Solver::automatic;
  double contact_noise = 0.0;  ///< probability that a touch sensor reads wrong at a tick; 0 to 1, drawn with the seed

  Overrides overrides;  ///< what replaced values of the files; it has been applied

  std::vector<SourceFile> sources;    ///< every file, the top-level file first
  std::string robot_file;             ///< path of the source that has the robot
  std::string actuation_file;         ///< path of the source that has the start values
  std::string environment_file;       ///< path of the source that has the environment
  std::vector<std::string> remarks;   ///< for the user: the joint map, tags without effect
  std::vector<std::string> warnings;  ///< for the user: what is valid and probably not meant
};

/// The ticks of a run: the duration, rounded to whole ticks; at least 1.
[[nodiscard]] inline std::uint32_t tick_count(const Scenario& scenario) {
  return static_cast<std::uint32_t>(
      std::max(1L, std::lround(scenario.duration_s * 1e6 / scenario.kernel.tick_period_us)));
}

/// Streams of Pcg32 with the scenario's seed. Each use has its own, so that no two draw the same numbers. The kernels
/// use 0 to 63, one for each joint.
namespace random_stream {
inline constexpr std::uint64_t crystals = 1'000'000;  ///< of the modules, plus the joint
inline constexpr std::uint64_t boards = 2'000'000;    ///< plus the joint
inline constexpr std::uint64_t touch_sensors = 3'000'000;
inline constexpr std::uint64_t friction = 4'000'000;  ///< first of the streams with the spreads of trials
inline constexpr std::uint64_t mass = 5'000'000;
inline constexpr std::uint64_t servo_gain = 6'000'000;
inline constexpr std::uint64_t latency = 7'000'000;
inline constexpr std::uint64_t start = 7'500'000;          ///< offsets of the start position
inline constexpr std::uint64_t faults = 8'000'000;         ///< with the seed of a fault schedule
inline constexpr std::uint64_t fault_effects = 9'000'000;  ///< which frames a fault destroys, and the like
}  // namespace random_stream

}  // namespace proleg::sim
