#pragma once

#include <optional>

#include "sim/robot/robot_control_entry.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads the element of a <Robot> that names a plug-in, if there is one:
///   <robot_control plugin="dynamixel">
///     <parameter name="device" value="/dev/ttyUSB0"/>
///     <parameter name="id" value="5" joint="J1"/>
///   </robot_control>
/// Checks joints, and that no parameter is given twice. Names and values are checked by the plug-in.
[[nodiscard]] std::optional<RobotControlEntry> read_robot_control(const XmlElement& robot, const RobotModel& model);

}  // namespace proleg::sim
