#include "sim/scenario/names.hpp"

#include <algorithm>

#include "sim/scenario/thesis_names.hpp"

namespace proleg::sim {

std::vector<unsigned> used_slots(const Scenario& scenario) {
  std::vector<unsigned> slots;
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    if (scenario.kernel.slots[slot].algorithm != nullptr) {
      slots.push_back(slot);
    }
  }
  return slots;
}

std::string slot_name(const Scenario& scenario, unsigned slot) {
  return std::string(scenario.kernel.slots[slot].algorithm->declaration().name) + " (" + std::to_string(slot + 1) + ")";
}

std::vector<std::string> slot_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const unsigned slot : used_slots(scenario)) {
    names.push_back(slot_name(scenario, slot));
  }
  return names;
}

std::vector<unsigned> find_slots(const Scenario& scenario, const std::string& module) {
  std::vector<unsigned> slots = used_slots(scenario);
  const ActuationModule* const named = find_named_algorithm(module);
  std::erase_if(slots, [&](unsigned slot) {
    const ActuationModule* const algorithm = scenario.kernel.slots[slot].algorithm;
    return algorithm != named && module != algorithm->declaration().name && module != std::to_string(slot + 1);
  });
  return slots;
}

std::vector<std::string> parameter_names(const Declaration& declaration) {
  std::vector<std::string> names;
  for (const Parameter& parameter : declaration.parameters) {
    names.emplace_back(parameter.name);
  }
  return names;
}

std::vector<std::string> joint_names(const RobotModel& robot, JointMask group) {
  std::vector<std::string> in_file_order(robot.joints.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    if (group.contains(static_cast<unsigned>(j))) {
      in_file_order[robot.joints[j].file_index] = robot.joints[j].name;
    }
  }
  std::erase(in_file_order, "");
  return in_file_order;
}

std::vector<std::string> joint_names(const RobotModel& robot) {
  return joint_names(robot, JointMask::first(static_cast<unsigned>(robot.joints.size())));
}

int find_joint(const RobotModel& robot, const std::string& name) {
  const auto joint = std::ranges::find(robot.joints, name, &Joint::name);
  return joint == robot.joints.end() ? -1 : static_cast<int>(joint - robot.joints.begin());
}

}  // namespace proleg::sim
