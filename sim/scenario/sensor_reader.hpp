#pragma once

#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/source_set.hpp"

namespace proleg::sim {

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

}  // namespace proleg::sim
