#pragma once

// The files of a new scenario: a robot, a gait that moves it, a flat floor.

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/robot_kinds.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// axes: for each joint from the tail 'p' (pitch) or 'y' (yaw); 1 to 64 characters. The names of the files are relative
/// to their folder; the top-level file is the first one.
[[nodiscard]] std::vector<SourceFile> new_scenario_files(const RobotKind& kind, const std::string& axes);

/// What the first gait of a robot depends on.
struct GaitJoint {
  std::string name;
  bool is_yaw = false;  ///< otherwise pitch
  /// Direction in the robot's frame of the axis about which the part towards the head turns. Joints of which it points
  /// the other way than that of most others swing in opposite phase.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double lower_deg = -90.0;
  double upper_deg = 90.0;
  double max_speed = 4.5;  ///< rad/s, above 0
};

/// An actuation file for robot.robot.xml: a travelling wave of the pitch joints, or one of these and one of the yaw
/// joints. Amplitudes stay within the limits, and the frequency is at most 1 Hz and such that no joint exceeds its
/// speed. joints: from the tail, 1 to 64.
[[nodiscard]] std::string first_gait_text(std::span<const GaitJoint> joints);

/// The files of a scenario with this robot.robot.xml: top-level file, robot, gait, flat floor. height: of the robot's
/// origin above the floor at the start, in m.
[[nodiscard]] std::vector<SourceFile> files_around_robot(std::string robot, std::string gait, double height);

}  // namespace proleg::sim
