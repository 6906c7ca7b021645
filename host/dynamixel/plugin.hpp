#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/dynamixel/line.hpp"
#include "host/robot_control_abi/robot_control.h"

namespace proleg::host {

/// The plug-in "dynamixel".
[[nodiscard]] const proleg_robot_control_plugin& dynamixel_plugin();

/// Opens the line to the servos at connect(). device, rate: from the robot's file. May throw LineError.
using LineMaker = std::function<std::unique_ptr<Line>(const std::string& device, unsigned rate)>;

/// Replaces SerialLine for all robots that are connected from now on. For tests on virtual time.
void use_lines_of(LineMaker make_line);

}  // namespace proleg::host
