#pragma once

#include <cstdint>
#include <string>

#include "shared/gait/declaration.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The value that a text gives a parameter, in its unit. Throws InputError for that place if it is not a number or not
/// in the declared range.
[[nodiscard]] std::int32_t parse_parameter(const Parameter& parameter, const std::string& text, const std::string& file,
                                           int line);

/// Gives a parameter its start value. Scenario::settings holds no value that is the default, none twice, and is in the
/// order of slot, joint, parameter.
void set_start_value(Scenario& scenario, const Setting& setting);

/// Names of what a declaration has, for messages.
[[nodiscard]] std::vector<std::string> parameter_names(const Declaration& declaration);

/// Names of the robot's joints in the order of its file; with a slot's group only those that it drives.
[[nodiscard]] std::vector<std::string> joint_names(const RobotModel& robot, JointMask group);

/// Kernel number of the joint with that name, or -1.
[[nodiscard]] int find_joint(const RobotModel& robot, const std::string& name);

}  // namespace proleg::sim
