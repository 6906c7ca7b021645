#pragma once

// Names of slots, parameters and joints: what a user may call them, and what messages call them;
// and the names that files of the 2013 thesis have for algorithms and parameters, beside those that Proleg declares. As
// in tags, capital letters make no difference in them.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/gait/actuation_module.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/robot/robot_model.hpp"
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

/// The algorithm that Proleg or the thesis calls so ("Global Adaptive Touch", listing B.7); null if there is none.
[[nodiscard]] const ActuationModule* find_named_algorithm(std::string_view name);

/// Position of the parameter that Proleg or the thesis calls so ("Get-stuck-threshold", "back to zero constant",
/// "Constant 1", "phase: p" for phase_difference), or -1.
[[nodiscard]] int find_named_parameter(const Declaration& declaration, std::string_view name);

/// The kernel joint whose angle the thesis calls so in DirectJointAccess ("Joint_0": the first joint of the robot's
/// file, as in the masks of <jointConfiguration>), or -1.
[[nodiscard]] int find_joint_of_thesis(const RobotModel& robot, std::string_view name);

/// What a message on an unknown parameter says after "expected one of" `parameters`: where the thesis's "timestep"
/// went, and which joints of the robot "Joint_9" could mean. Mostly empty.
[[nodiscard]] std::string hint_on_thesis_name(const RobotModel& robot, std::span<const std::string> parameters,
                                              std::string_view name);

}  // namespace proleg::sim
