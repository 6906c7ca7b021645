#pragma once

// Pictures of a robot that crosses an obstacle: figures 6.8 and 7.3 of the thesis.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// Bounds of an obstacle along y, in m.
struct ObstacleExtent {
  double from = 0.0;
  double to = 0.0;
};

/// Extent of the object with the name "obstacle"; both bounds are 0 if the environment has no such object.
[[nodiscard]] ObstacleExtent obstacle_extent(const sim::EnvironmentModel& environment);

/// A robot at one moment.
struct CrossingStage {
  std::string name;  ///< "on the second hill"
  double time_s = 0.0;
  std::vector<sim::Pose> link_poses;
  std::vector<std::uint8_t> contacts;  ///< contacts of each link; not 0: the link touches
};

/// Draws figure 6.8 as SVG: the stages from the side, one below the other.
[[nodiscard]] std::string draw_crossing(const sim::Scenario& scenario, std::span<const CrossingStage> stages);

/// A gait and its distance.
struct RulerMark {
  std::string name;
  double distance_m = 0.0;
};

/// Draws figure 7.3 as SVG: the distances on a ruler of 1 m segments, with the obstacle above it. Distances count from
/// the position of the robot.
[[nodiscard]] std::string draw_distances(const sim::Scenario& scenario, std::span<const RulerMark> marks);

}  // namespace proleg::optimize
