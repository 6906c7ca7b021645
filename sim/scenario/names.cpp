#include "sim/scenario/names.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::sim {
namespace {

struct TwoNames {
  std::string_view thesis;
  std::string_view proleg;
};

constexpr std::array<TwoNames, 1> thesis_algorithms{{{"Global Adaptive Touch", "SensingModule_global_adaptive_touch"}}};

constexpr std::array<TwoNames, 15> thesis_parameters{{
    // The names in the dialogues of figure 4.20 and in the command of figure 4.12.
    {"amplitude: a", "amplitude"},
    {"frequency: f", "frequency"},
    {"phase: p", "phase_difference"},
    {"offset: o", "offset"},
    {"PhaseDifference", "phase_difference"},
    {"Get-stuck-threshold", "stuck_threshold"},
    {"back to zero constant", "recovering"},
    {"Constant 1", "constant_1"},
    {"Constant 2", "constant_2"},
    {"Constant 3", "constant_3"},
    {"Constant 4", "constant_4"},
    {"Constant 5", "constant_5"},
    {"Constant 6", "constant_6"},
    {"Constant 7", "constant_7"},
    {"Constant 8", "constant_8"},
}};

/// The text in front of the number of a joint, in small letters.
constexpr std::string_view joint_of_thesis = "joint_";

std::string_view proleg_name(std::span<const TwoNames> names, std::string_view name) {
  const auto found =
      std::ranges::find_if(names, [&](const TwoNames& each) { return lower_case(each.thesis) == lower_case(name); });
  return found == names.end() ? name : found->proleg;
}

}  // namespace

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

const ActuationModule* find_named_algorithm(std::string_view name) {
  return find_algorithm(proleg_name(thesis_algorithms, name));
}

int find_named_parameter(const Declaration& declaration, std::string_view name) {
  const int index = find_parameter(declaration, name);
  return index >= 0 ? index : find_parameter(declaration, proleg_name(thesis_parameters, name));
}

int find_joint_of_thesis(const RobotModel& robot, std::string_view name) {
  const std::string word = lower_case(name);
  const std::optional<unsigned> number =
      word.starts_with(joint_of_thesis) ? parse_whole<unsigned>(word.substr(joint_of_thesis.size())) : std::nullopt;
  const auto found = number ? std::ranges::find(robot.joints, *number, &Joint::file_index) : robot.joints.end();
  return found == robot.joints.end() ? -1 : static_cast<int>(found - robot.joints.begin());
}

std::string hint_on_thesis_name(const RobotModel& robot, std::span<const std::string> parameters,
                                std::string_view name) {
  const std::string word = lower_case(name);
  if (word.starts_with("timestep")) {
    return "; the time step of all algorithms is <tick> of the simulation file";
  }
  const bool is_joint = word.starts_with(joint_of_thesis) && std::ranges::find(parameters, "angle") != parameters.end();
  if (is_joint && !robot.joints.empty()) {
    return "; the joints of this robot are Joint_0 to Joint_" + std::to_string(robot.joints.size() - 1);
  }
  return "";
}

}  // namespace proleg::sim
