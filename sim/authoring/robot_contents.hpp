#pragma once

// The robot of a draft as a person edits it: a chain of links and joints, its servos and its sensors.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {

struct JointContents {
  std::string name;
  /// The joint is in the robot's file; else it is in a file of its own and cannot be edited here.
  bool is_editable = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< as in the file
  double lower_deg = 0.0;
  double upper_deg = 0.0;
  double max_torque = 0.0;  ///< Nm
  double max_speed = 0.0;   ///< rad/s
};

struct LinkContents {
  std::string name;
  std::string file;                ///< that has its <Body>
  std::size_t same_count = 1;      ///< links of the robot that have this <Body>
  double mass = 0.0;               ///< kg
  std::optional<double> friction;  ///< of its first geometry
};

struct SensorContents {
  AttachedSensor sensor;
  std::string part;  ///< name of its link or joint
  ElementNumber element = 0;
};

struct OwnKindContents {
  std::string name;
  double length = 0.0;  ///< m, between two joints
};

struct RobotContents {
  std::string file;
  std::vector<JointContents> joints;    ///< kernel order: from the head
  std::vector<LinkContents> links;      ///< from the head
  std::vector<SensorContents> sensors;  ///< in the order of the file; those that are switched off are not here
  std::vector<OwnKindContents> kinds;   ///< of modules that a person has made of meshes
  /// Why links cannot be added, removed or exchanged; nothing: they can.
  std::optional<std::string> obstacle;
};

[[nodiscard]] RobotContents read_robot_contents(const Draft& draft);

}  // namespace proleg::sim
