#include "sim/scenario/actuation_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/thesis_names.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

const ActuationModule& read_algorithm(const XmlElement& module) {
  const std::string name = module.required_attribute("name");
  const ActuationModule* algorithm = find_named_algorithm(name);
  if (algorithm == nullptr) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < algorithm_count(); ++i) {
      known.emplace_back(algorithm_at(i).declaration().name);
    }
    module.refuse("unknown algorithm " + in_quotes(name),
                  "one of " + listed(known) + ", or that of a library (--algorithms)");
  }
  return *algorithm;
}

JointMask read_group(const XmlElement& module, const RobotModel& robot) {
  const XmlElement element = module.required_child("jointConfiguration");
  element.allow({"joints"}, {});
  const std::string mask = element.required_attribute("joints");
  if (mask.size() != robot.joints.size() || mask.find_first_not_of("01") != std::string::npos) {
    element.refuse(
        "joints " + in_quotes(mask),
        std::to_string(robot.joints.size()) + " characters 0 or 1, one for each joint in the order of the robot file");
  }
  JointMask group;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    if (mask[robot.joints[j].file_index] == '1') {
      group.insert(static_cast<unsigned>(j));
    }
  }
  return group;
}

ParameterEntry read_parameter(const XmlElement& element, const Scenario& scenario, const Slot& slot) {
  element.allow({"name", "value", "unit", "joint"}, {});
  const Declaration& declaration = slot.algorithm->declaration();
  ParameterEntry entry;
  const std::string name = element.required_attribute("name");
  int index = find_named_parameter(declaration, name);
  if (index < 0 && !element.attribute("joint")) {
    entry.joint = find_joint_of_thesis(scenario.robot, name);
    index = entry.joint < 0 ? -1 : find_parameter(declaration, "angle");
  }
  if (index < 0) {
    const std::vector<std::string> known = parameter_names(declaration);
    element.refuse("unknown parameter " + in_quotes(name) + " of " + std::string(declaration.name),
                   "one of " + listed(known) + hint_on_thesis_name(scenario.robot, known, name));
  }
  entry.index = static_cast<unsigned>(index);
  const Parameter& parameter = declaration.parameters[entry.index];
  const std::string symbol = scale_of(parameter.unit).symbol;
  if (const auto unit = element.attribute("unit"); unit && *unit != symbol) {
    element.refuse("unit " + in_quotes(*unit) + " for parameter " + in_quotes(name), "unit '" + symbol + "'");
  }
  entry.value =
      parse_parameter(parameter, element.required_attribute("value"), element.document().name(), element.line());
  if (const auto joint = element.attribute("joint")) {
    entry.joint = find_joint(scenario.robot, *joint);
    if (entry.joint < 0) {
      element.refuse("unknown joint " + in_quotes(*joint), "one of " + listed(joint_names(scenario.robot, slot.group)));
    }
  }
  if (entry.joint >= 0 && !slot.group.contains(static_cast<unsigned>(entry.joint))) {
    element.refuse("a joint that this module does not drive, " +
                       in_quotes(scenario.robot.joints[static_cast<std::size_t>(entry.joint)].name),
                   "one of " + listed(joint_names(scenario.robot, slot.group)));
  }
  return entry;
}

void read_parameters(const XmlElement& module, unsigned slot_number, Scenario& scenario) {
  const Slot& slot = scenario.kernel.slots[slot_number];
  std::vector<ParameterEntry> entries = read_parameter_entries(module, scenario, slot_number);
  // Values for all joints first, in any order of the file.
  std::stable_partition(entries.begin(), entries.end(), [](const ParameterEntry& entry) { return entry.joint < 0; });
  for (const ParameterEntry& entry : entries) {
    for (unsigned j = 0; j < scenario.kernel.joint_count; ++j) {
      if (slot.group.contains(j) && (entry.joint < 0 || static_cast<unsigned>(entry.joint) == j)) {
        Setting setting;
        setting.slot = static_cast<std::uint8_t>(slot_number);
        setting.joint = static_cast<std::uint8_t>(j);
        setting.index = static_cast<std::uint8_t>(entry.index);
        setting.value = entry.value;
        set_start_value(scenario, setting);
      }
    }
  }
}

/// Throws InputError if the kernel rejects the configuration so far.
void check_with_kernel(const XmlElement& place, const KernelConfiguration& configuration) {
  std::vector<JointMemory> memory(configuration.joint_count);
  Kernel kernel(memory);
  if (const Status status = kernel.configure(configuration, 0); status != Status::ok) {
    place.refuse(
        "a configuration that the control kernel rejects with " + place.label() + ": " + std::string(describe(status)),
        "a configuration that it accepts");
  }
}

}  // namespace

void read_actuation(const XmlDocument& document, Scenario& scenario, const std::string& robot_file) {
  const XmlElement root = document.root("actuation");
  root.allow({}, {"validRobot", "actuationModule"});
  if (const auto valid = root.child("validRobot")) {
    valid->allow({"robotName"}, {});
    const std::string name = valid->required_attribute("robotName");
    if (const std::string present = std::filesystem::path(robot_file).filename().string(); name != present) {
      scenario.warnings.push_back(one_line(document.name() + ":" + std::to_string(valid->line()) +
                                           ": the actuation was made for robot " + in_quotes(name) + ", not for " +
                                           in_quotes(present)));
    }
  }

  const std::vector<XmlElement> modules = actuation_modules(document);
  for (unsigned slot_number = 0; slot_number < modules.size(); ++slot_number) {
    const XmlElement& module = modules[slot_number];
    if (slot_number == max_slots) {
      module.refuse("a fifth " + module.label(), "at most " + std::to_string(max_slots));
    }
    module.allow({"name"}, {"jointConfiguration", "parameter"});
    Slot& slot = scenario.kernel.slots[slot_number];
    slot.algorithm = &read_algorithm(module);
    slot.group = read_group(module, scenario.robot);
    check_with_kernel(module, scenario.kernel);
    if (slot.group.empty()) {
      remark_no_effect(scenario.warnings, module, "it drives no joint");
    }
    read_parameters(module, slot_number, scenario);
  }
  if (modules.empty()) {
    root.refuse("no <actuationModule> in " + root.label(), "1 to " + std::to_string(max_slots));
  }
}

std::vector<XmlElement> actuation_modules(const XmlDocument& document) {
  std::vector<XmlElement> modules;
  for (const XmlElement& child : document.root("actuation").children()) {
    if (child.is("actuationModule")) {
      modules.push_back(child);
    }
  }
  return modules;
}

std::vector<ParameterEntry> read_parameter_entries(const XmlElement& module, const Scenario& scenario, unsigned slot) {
  std::vector<ParameterEntry> entries;
  std::set<std::pair<unsigned, int>> seen;
  for (const XmlElement& child : module.children()) {
    if (!child.is("parameter")) {
      continue;
    }
    const ParameterEntry& entry = entries.emplace_back(read_parameter(child, scenario, scenario.kernel.slots[slot]));
    if (!seen.insert({entry.index, entry.joint}).second) {
      const std::string name = child.required_attribute("name");
      const std::string_view own_name =
          scenario.kernel.slots[slot].algorithm->declaration().parameters[entry.index].name;
      child.refuse("parameter " + in_quotes(name) +
                       (lower_case(name) == lower_case(own_name) ? "" : ", which is " + std::string(own_name) + ",") +
                       " twice for the same joints",
                   "it once");
    }
  }
  return entries;
}

}  // namespace proleg::sim
