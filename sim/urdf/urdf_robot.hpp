#pragma once

// A robot as its URDF file has it (Unified Robot Description Format of ROS, https://wiki.ros.org/urdf/XML): a tree of
// links and joints. Lengths are metres, masses kilograms, angles radians; x is forward and z up.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/pose.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/urdf/urdf_shapes.hpp"

namespace proleg::sim {

struct UrdfLink {
  std::string name;
  /// Of an <inertial> with a mass above 0; in the frame of the link. An inertia of 0 is not given.
  std::optional<MassProperties> mass;
  std::vector<UrdfShape> visuals;
  std::vector<UrdfShape> collisions;
  std::optional<double> friction;  ///< <mu1> of a <gazebo> for this link
  int line = 0;
};

struct UrdfJoint {
  enum class Kind : std::uint8_t { revolute, continuous, fixed };
  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = 0;                           ///< number of a link
  std::size_t child = 0;                            ///< number of a link, whose frame is that of the joint
  Pose origin;                                      ///< of the child in the frame of the parent, at angle 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector in the frame of the child
  double lower = 0.0;                               ///< rad; of a revolute joint
  double upper = 0.0;                               ///< rad, not below `lower`
  double effort = 0.0;                              ///< Nm, not negative; 0: not given, or no limit
  double velocity = 0.0;                            ///< rad/s, not negative; 0: not given, or no limit
  int line = 0;
};

struct UrdfRobot {
  std::string file;  ///< for messages
  std::string name;
  std::vector<UrdfLink> links;        ///< in the order of the file, at least one
  std::vector<UrdfJoint> joints;      ///< in the order of the file: a tree of all links
  std::size_t root = 0;               ///< number of the link that is no child
  std::vector<std::string> lost;      ///< what the file has and this structure has not, one line each, with lines
  std::vector<std::string> notes;     ///< what was chosen, one line each, with lines
  std::vector<std::string> warnings;  ///< what is probably not meant, with file and line
};

/// Reads a URDF file of version 1.0 to 1.2. What is only for the eye never refuses a robot, unless no link has a
/// <collision>. path: for messages. Throws InputError for what is no URDF, for a number that is none or out of range,
/// for a joint that no servo with a hinge can be (prismatic, floating, planar, mimic), and for links and joints that
/// form no tree.
[[nodiscard]] UrdfRobot read_urdf(const std::filesystem::path& path, const std::string& text);

}  // namespace proleg::sim
