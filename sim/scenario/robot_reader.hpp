#pragma once

// Reads the file of a robot, and the parts of it that describe what drives the robot and what it senses.

#include <optional>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads the element of a <Robot> that names a plug-in, if there is one:
///   <robot_control plugin="dynamixel">
///     <parameter name="device" value="/dev/ttyUSB0"/>
///     <parameter name="id" value="5" joint="J1"/>
///   </robot_control>
/// Checks joints, and that no parameter is given twice. Names and values are checked by the plug-in.
[[nodiscard]] std::optional<RobotControlEntry> read_robot_control(const XmlElement& robot, const RobotModel& model);

/// Reads the elements <module joint="J1" node="5" serial="0x1234ABCD"/> of a <Robot>: which module drives which joint.
/// The serial number, decimal or hexadecimal, is optional. There is one element for each joint, in any order, or none:
/// then kernel joint j has the module with node id j + 1. The result is in kernel order.
[[nodiscard]] std::vector<ModulePlace> read_modules(const XmlElement& robot, const RobotModel& model);

/// Reads the sensors of a robot, in the order of the file:
///   <AttachedSensor name="eye">
///     <link>Head</link>  (of a ServoCurrent: <joint>)
///     <translation>, <rotationaxis>, <quat>: the sensor's frame in that of the link
///     <sensor type="BaseLaser2D">...</sensor>  (or file="laser.sensor.xml", a file with this element)
///   </AttachedSensor>
/// A sensor whose <power> is 0 is left out. Throws InputError for links and joints that the robot does not have, values
/// out of range, and a second sensor of the same name or at the same input.
[[nodiscard]] std::vector<AttachedSensor> read_sensors(const XmlElement& robot, const RobotModel& model,
                                                       SourceSet& sources, std::vector<std::string>& remarks);

struct RobotDescription {
  RobotModel model;
  std::vector<AngleLimits> kernel_limits;          ///< kernel order
  std::vector<ModulePlace> modules;                ///< kernel order
  std::optional<RobotControlEntry> robot_control;  ///< the plug-in of a robot without modules
  std::vector<std::string> warnings;               ///< what is probably not meant
  /// Warnings that hold if links touch each other (EnvironmentModel::self_collision).
  std::vector<std::string> contact_warnings;
};

/// Reads a robot file: <Robot> with KinBodies and joints as in OpenRAVE, and our
///   <servo><gain>50</gain><period unit="ms">1</period><latency unit="ms">0</latency></servo>
/// (gain in 1/s; what is missing is as in ServoModel), the modules, the plug-in and the sensors. Adds the joint map to
/// the remarks. step_s: of the physics; bounds the gain.
[[nodiscard]] RobotDescription read_robot(const XmlDocument& document, double step_s, SourceSet& sources,
                                          std::vector<std::string>& remarks);

}  // namespace proleg::sim
