#pragma once

// Names of slots, parameters and joints: what a user may call them, and what messages call them.

#include <string>
#include <vector>

#include "shared/gait/declaration.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Slots that have an algorithm.
[[nodiscard]] std::vector<unsigned> used_slots(const Scenario& scenario);

/// "PatternGenerator_sinusoidal (2)": the algorithm of a used slot, and the number of the slot, from 1.
[[nodiscard]] std::string slot_name(const Scenario& scenario, unsigned slot);

/// The names of all used slots.
[[nodiscard]] std::vector<std::string> slot_names(const Scenario& scenario);

/// The used slots that `module` names: an algorithm's name, or the number of a slot.
[[nodiscard]] std::vector<unsigned> find_slots(const Scenario& scenario, const std::string& module);

[[nodiscard]] std::vector<std::string> parameter_names(const Declaration& declaration);

/// Names of the joints in a group, in the order of the robot's file.
[[nodiscard]] std::vector<std::string> joint_names(const RobotModel& robot, JointMask group);

/// Names of all joints, in the order of the robot's file.
[[nodiscard]] std::vector<std::string> joint_names(const RobotModel& robot);

/// Kernel number of the joint with that name, or -1.
[[nodiscard]] int find_joint(const RobotModel& robot, const std::string& name);

}  // namespace proleg::sim
