#pragma once

// Pictures of a robot that crosses an obstacle: figures 6.8 and 7.3 of the thesis.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// Where an obstacle is along y, in m.
struct ObstacleExtent {
  double from = 0.0;
  double to = 0.0;
};

/// The object of the environment with the name "obstacle"; both 0 if there is none.
[[nodiscard]] ObstacleExtent obstacle_extent(const sim::EnvironmentModel& environment);

/// A robot at one moment.
struct CrossingStage {
  std::string name;  ///< "on the second hill"
  double time_s = 0.0;
  std::vector<sim::Pose> link_poses;
  std::vector<std::uint8_t> contacts;  ///< of each link; not 0: it touches
};

/// Figure 6.8, SVG: the stages from the side, one below the other.
[[nodiscard]] std::string draw_crossing(const sim::Scenario& scenario, std::span<const CrossingStage> stages);

/// A gait and how far it went.
struct RulerMark {
  std::string name;
  double distance_m = 0.0;
};

/// Figure 7.3, SVG: the distances on a ruler of 1 m segments, with the obstacle above it. distances count from the
/// position of the robot.
[[nodiscard]] std::string draw_distances(const sim::Scenario& scenario, std::span<const RulerMark> marks);

}  // namespace proleg::optimize
