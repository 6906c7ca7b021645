#pragma once

// Changes of the parts that a robot of a draft has: axes, limits, servos, masses, names.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_elements.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Joints and links are in kernel order, from the head. Throws InputError for one that does not exist or cannot be
/// edited; the reader judges the values.
class RobotChange {
 public:
  /// scenario: of the draft, before the change.
  RobotChange(const Scenario& scenario, DraftChange& change) : scenario_(scenario), change_(change) {}

  /// The axis in the frame of the joint's file: 1 0 0 is pitch and 0 0 1 yaw, if the robot lies along y.
  void set_axis(JointMask joints, const Eigen::Vector3d& axis);
  void set_limits(JointMask joints, double lower_degrees, double upper_degrees);
  void set_max_torque(JointMask joints, double newton_metres);
  void set_max_speed(JointMask joints, double radians_per_second);
  /// The joint has its new name in the actuation file and in sensors, too.
  void rename_joint(unsigned joint, const std::string& name);
  /// New names by the present ones, all at once: joints can exchange their names.
  void rename_joints(const std::map<std::string, std::string>& names);
  /// The robot's own name.
  void rename(const std::string& name);
  /// Sets a value of <servo>: "gain" (1/s), "period" (ms), "commandspeed" (degrees/s), "latency" (ms).
  void set_servo(std::string_view tag, double value);
  /// In kg; of all links that have the same <Body>.
  void set_mass(std::size_t link, double mass);
  /// Of all geometries of the link, and of all links that have the same <Body>; nothing: that of what it touches.
  void set_friction(std::size_t link, std::optional<double> friction);

 private:
  [[nodiscard]] const XmlText& xml() { return change_.xml(scenario_.robot_file); }
  /// The elements of joints, the last one of the file first: an edit does not move the elements before it.
  [[nodiscard]] std::vector<ElementNumber> joints_from_the_end(JointMask joints);
  [[nodiscard]] LinkElements link_elements(std::size_t link);
  void set_number(JointMask joints, std::string_view tag, double value);

  const Scenario& scenario_;
  DraftChange& change_;
};

/// Exchanges names of joints where the files of the scenario name them: in <module>, <robot_control>, <AttachedSensor>
/// and <parameter>; with_joints: in <Joint>, too. names: new names by the old ones, all at once.
void replace_joint_names(DraftChange& change, const Scenario& scenario, const std::map<std::string, std::string>& names,
                         bool with_joints);

}  // namespace proleg::sim
