#pragma once

// A robot as data: links, hinge joints and servos, in metres, kilograms, radians and newtons, independent of the
// physics engine and of file formats; and what drives the real one, modules or a plug-in.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "shared/kernel/servo_pulses.hpp"
#include "sim/robot/attached_sensor.hpp"
#include "sim/robot/pose.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

enum class Shape : std::uint8_t {
  box,
  sphere,
  cylinder,      ///< axis along y, as in OpenRAVE
  hull,          ///< a convex solid: of links and of bodies that move
  surface,       ///< triangles, of static objects only
  height_field,  ///< of static objects only
};

/// "a box", for messages.
[[nodiscard]] constexpr std::string_view with_article(Shape shape) {
  switch (shape) {
    case Shape::box:
      return "a box";
    case Shape::sphere:
      return "a sphere";
    case Shape::cylinder:
      return "a cylinder";
    case Shape::hull:
      return "a convex mesh";
    case Shape::surface:
      return "a triangle mesh";
    case Shape::height_field:
      return "a height field";
  }
  return "";
}

/// A solid that collides.
struct Geometry {
  Shape shape = Shape::box;
  Pose pose;  ///< in the frame of the link
  /// box: half the side lengths; sphere: radius in x; cylinder: radius in x, half the height in y; others: half the
  /// side lengths of the box around the mesh, about the origin of its frame. All above 0.
  Eigen::Vector3d extents = Eigen::Vector3d::Zero();
  /// hull: its surface; surface, height_field: what is touched; others: null. Copies of a geometry share it.
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const HeightField> heights;  ///< of a height field, otherwise null
  /// Coulomb coefficient, not negative; without one that of the other geometry applies. Two of them: the geometric
  /// mean.
  std::optional<double> friction;
  /// The coefficient across the body, as of a snake's belly: perpendicular to the y axis of its frame, along which
  /// robots lie. `friction` then holds along this axis only. Without it friction is the same in every direction.
  std::optional<double> friction_across;
  bool is_shown = true;  ///< false: a Look is shown in its place
};

/// Coefficient between two geometries of which neither has one.
inline constexpr double default_friction = 0.1;

struct MassProperties {
  double mass = 0.0;                                      ///< kg, above 0
  Eigen::Vector3d center = Eigen::Vector3d::Zero();       ///< centre of mass in the frame of the link
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  ///< about the centre of mass, positive definite
};

/// What is shown and does not collide.
struct Look {
  Pose pose;  ///< in the frame of the link
  std::shared_ptr<const TriangleMesh> mesh;
};

struct Link {
  std::string name;
  Pose pose;  ///< in the robot's frame when all joint angles are 0
  MassProperties mass;
  std::vector<Geometry> geometries;
  std::vector<Look> looks;  ///< shown beside the geometries
};

/// Kernel joint j connects link j (towards the head) with link j + 1 (towards the tail).
struct Joint {
  std::string name;
  std::size_t file_index = 0;                        ///< position of the joint in its file, from 0
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< in the robot's frame
  /// Unit vector in the robot's frame. The joint angle is the rotation of the link towards the head about this axis,
  /// relative to the link towards the tail.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double lower_limit = 0.0;  ///< rad
  double upper_limit = 0.0;  ///< rad
  double max_torque = 0.0;   ///< Nm, above 0
  double max_speed = 0.0;    ///< rad/s, above 0
};

/// A position servo: a proportional controller on the angle commands a speed, which the motor reaches if its torque
/// suffices. The servo takes one pulse in each of its periods.
struct ServoModel {
  double gain = 8.3;  ///< 1/s, above 0; the default is that of the OpenMR servo plug-in
  std::uint32_t period_us = 20'000;
  std::uint32_t command_speed = default_command_speed;  ///< greatest speed of commanded angles, degrees a second
  std::uint32_t latency_us = 0;  ///< from a pulse, or the lack of one, until the servo acts on it; up to 100000
};

struct RobotModel {
  std::string name;
  std::vector<Link> links;    ///< from head to tail; one more than joints
  std::vector<Joint> joints;  ///< kernel order: from head to tail
  ServoModel servo;
  std::vector<AttachedSensor> sensors;  ///< beside the two touch sensors of every link; in the order of the file
};

/// Which way a joint bends the robot that lies as in its file.
enum class JointDirection : std::uint8_t {
  pitch,  ///< up and down: its axis is rather horizontal
  yaw,    ///< to the sides: its axis is rather vertical
};

[[nodiscard]] inline JointDirection direction_of(const Joint& joint) {
  constexpr double cosine_of_45_degrees = 0.7071;
  return std::abs(joint.axis.z()) > cosine_of_45_degrees ? JointDirection::yaw : JointDirection::pitch;
}

/// The ends of a link, in the robot's frame at angles 0.
struct LinkEnds {
  Eigen::Vector3d rear;
  Eigen::Vector3d front;
};

/// A link ends at its joints. An end link reaches as far beyond its centre of mass as its joint is from it.
inline LinkEnds link_ends(const RobotModel& robot, std::size_t link) {
  const Eigen::Vector3d center = robot.links[link].pose * robot.links[link].mass.center;
  LinkEnds ends{center, center};
  if (link < robot.joints.size()) {
    ends.rear = robot.joints[link].anchor;
  }
  if (link > 0) {
    ends.front = robot.joints[link - 1].anchor;
  }
  if (link == 0) {
    ends.front = 2.0 * center - ends.rear;
  }
  if (link == robot.joints.size()) {
    ends.rear = 2.0 * center - ends.front;
  }
  return ends;
}

/// Coulomb coefficient of two geometries that touch, from those that they have. unspecified: where neither has one.
[[nodiscard]] inline double friction_of(std::optional<double> a, std::optional<double> b, double unspecified) {
  if (a && b) {
    return std::sqrt(*a * *b);
  }
  return a.value_or(b.value_or(unspecified));
}

/// The <robot_control> of a robot's file: the plug-in that drives a robot without Proleg's modules. The simulation
/// ignores it; only the plug-in defines which parameters there are.
struct RobotControlEntry {
  struct Parameter {
    std::string name;
    std::string value;
    std::optional<std::uint32_t> joint;  ///< kernel order; nothing: for all joints
    int line = 0;

    friend bool operator==(const Parameter&, const Parameter&) = default;
  };

  std::string plugin;  ///< a name, or a path relative to the folder of the file
  std::string file;    ///< as messages show it
  std::string folder;  ///< folder of the file that has the element
  int line = 0;        ///< line of the element
  std::vector<Parameter> parameters;
};

inline constexpr std::uint8_t max_module_node = 126;  ///< the highest CANopen node id that a module can have

/// The module that drives a joint.
struct ModulePlace {
  std::uint8_t node = 1;                ///< CANopen node id, 1 to max_module_node; unique in the robot
  std::optional<std::uint32_t> serial;  ///< the serial number that the module must have; nothing: any

  friend bool operator==(const ModulePlace&, const ModulePlace&) = default;
};

}  // namespace proleg::sim
