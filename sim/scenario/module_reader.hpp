#pragma once

#include <vector>

#include "sim/robot/module_place.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads the elements <module joint="J1" node="5" serial="0x1234ABCD"/> of a <Robot>: which module drives which joint.
/// The serial number, decimal or hexadecimal, is optional. There is one element for each joint, in any order, or none:
/// then kernel joint j has the module with node id j + 1. The result is in kernel order.
[[nodiscard]] std::vector<ModulePlace> read_modules(const XmlElement& robot, const RobotModel& model);

}  // namespace proleg::sim
