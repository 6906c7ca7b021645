#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

/// The start value at the place of a setting, whose own value does not matter.
[[nodiscard]] std::int32_t start_value(const Scenario& scenario, const Setting& place);

/// "PatternGenerator_sinusoidal (2)": a used slot's algorithm and the slot's number from 1, for messages.
[[nodiscard]] std::string slot_name(const Scenario& scenario, unsigned slot);

/// That of each used slot.
[[nodiscard]] std::vector<std::string> slot_names(const Scenario& scenario);

/// Used slots that a person means by `module`: an algorithm's name, or the number of a slot.
[[nodiscard]] std::vector<unsigned> find_slots(const Scenario& scenario, const std::string& module);

/// Names of what a declaration has, for messages.
[[nodiscard]] std::vector<std::string> parameter_names(const Declaration& declaration);

/// Names of the robot's joints in the order of its file; with a slot's group only those that it drives.
[[nodiscard]] std::vector<std::string> joint_names(const RobotModel& robot, JointMask group);

/// Kernel number of the joint with that name, or -1.
[[nodiscard]] int find_joint(const RobotModel& robot, const std::string& name);

}  // namespace proleg::sim
