#pragma once

// Writes a robot in URDF, for ROS and other simulators.

#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// With what the files of an export begin, XML files in a comment.
inline constexpr std::string_view export_mark = "Written by 'proleg export'";

struct UrdfExport {
  std::string text;
  std::vector<SourceFile> meshes;  ///< STL files; paths relative to the folder of the URDF file
  std::vector<std::string> lost;   ///< what the robot has and URDF has not, one line each
};

/// Links and joints keep their names. The root is a link "base_link" without mass, whose x axis points forward as that
/// of ROS robots; the tail is fixed to it, and the frame of every other link is at its joint towards the tail. Joint
/// angles have the sign of Proleg's. The friction of a link is in a <gazebo>, as Gazebo reads it.
/// mesh_folder: where the meshes are meant to be, relative to the folder of the URDF file.
[[nodiscard]] UrdfExport export_urdf(const RobotModel& robot, const std::string& mesh_folder);

}  // namespace proleg::sim
