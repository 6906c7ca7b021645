#include "sim/scenario/actuation_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

/// The names of modules that are no algorithm's, each once.
std::vector<std::string> unknown_algorithms(const XmlDocument& document) {
  std::vector<std::string> unknown;
  for (const XmlElement& module : actuation_modules(document)) {
    const std::optional<std::string> name = module.attribute("name");
    if (name && find_named_algorithm(*name) == nullptr && std::ranges::find(unknown, *name) == unknown.end()) {
      unknown.push_back(*name);
    }
  }
  return unknown;
}

const ActuationModule& read_algorithm(const XmlElement& module, const XmlDocument& document) {
  const std::string name = module.required_attribute("name");
  const ActuationModule* algorithm = find_named_algorithm(name);
  if (algorithm == nullptr) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < algorithm_count(); ++i) {
      known.emplace_back(algorithm_at(i).declaration().name);
    }
    throw UnknownAlgorithms(InputError(document.name(), module.line(), "unknown algorithm " + in_quotes(name),
                                       "one of " + listed(known) + ", or that of a library (--algorithms)"),
                            unknown_algorithms(document));
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

ParameterTag read_parameter_tag(const XmlElement& element, const Scenario& scenario, unsigned slot_number) {
  element.allow({"name", "value", "unit", "joint"}, {});
  const Slot& slot = scenario.kernel.slots[slot_number];
  const Declaration& declaration = slot.algorithm->declaration();
  const std::string name = element.required_attribute("name");
  int joint = -1;
  int number = find_named_parameter(declaration, name);
  if (number < 0 && !element.attribute("joint")) {
    joint = find_joint_of_thesis(scenario.robot, name);
    number = joint < 0 ? -1 : find_parameter(declaration, "angle");
  }
  if (number < 0) {
    const std::vector<std::string> known = parameter_names(declaration);
    element.refuse("unknown parameter " + in_quotes(name) + " of " + std::string(declaration.name),
                   "one of " + listed(known) + hint_on_thesis_name(scenario.robot, known, name));
  }
  const Parameter& parameter = declaration.parameters[static_cast<unsigned>(number)];
  const std::string symbol = scale_of(parameter.unit).symbol;
  if (const auto unit = element.attribute("unit"); unit && *unit != symbol) {
    element.refuse("unit " + in_quotes(*unit) + " for parameter " + in_quotes(name), "unit '" + symbol + "'");
  }
  const std::int32_t value =
      parse_parameter(parameter, element.required_attribute("value"), element.document().name(), element.line());
  if (const auto joint_name = element.attribute("joint")) {
    joint = find_joint(scenario.robot, *joint_name);
    if (joint < 0) {
      element.refuse("unknown joint " + in_quotes(*joint_name),
                     "one of " + listed(joint_names(scenario.robot, slot.group)));
    }
  }
  if (joint >= 0 && !slot.group.contains(static_cast<unsigned>(joint))) {
    element.refuse("a joint that this module does not drive, " +
                       in_quotes(scenario.robot.joints[static_cast<std::size_t>(joint)].name),
                   "one of " + listed(joint_names(scenario.robot, slot.group)));
  }
  return {.setting = {.slot = static_cast<std::uint8_t>(slot_number),
                      .joint = static_cast<std::uint8_t>(std::max(joint, 0)),
                      .number = static_cast<std::uint8_t>(number),
                      .value = value},
          .is_for_all = joint < 0};
}

void read_parameters(const XmlElement& module, unsigned slot_number, Scenario& scenario) {
  const Slot& slot = scenario.kernel.slots[slot_number];
  std::vector<ParameterTag> tags = read_parameter_tags(module, scenario, slot_number);
  // Values for all joints first, in any order of the file.
  std::stable_partition(tags.begin(), tags.end(), [](const ParameterTag& tag) { return tag.is_for_all; });
  for (const ParameterTag& tag : tags) {
    Setting setting = tag.setting;
    for (const unsigned joint : tag.is_for_all ? slot.group : JointMask::of(setting.joint)) {
      setting.joint = static_cast<std::uint8_t>(joint);
      set_start_value(scenario, setting);
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
    slot.algorithm = &read_algorithm(module, document);
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
  if (const auto contradiction = find_contradiction(scenario)) {
    modules[contradiction->slot].refuse(contradiction->found, contradiction->expected);
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

std::vector<ParameterTag> read_parameter_tags(const XmlElement& module, const Scenario& scenario, unsigned slot) {
  std::vector<ParameterTag> tags;
  for (const XmlElement& child : module.children()) {
    if (!child.is("parameter")) {
      continue;
    }
    const ParameterTag tag = read_parameter_tag(child, scenario, slot);
    if (std::ranges::any_of(tags, [&tag](const ParameterTag& earlier) {
          return earlier.is_for_all == tag.is_for_all && earlier.setting.has_same_place(tag.setting);
        })) {
      const std::string name = child.required_attribute("name");
      const std::string_view own_name =
          scenario.kernel.slots[slot].algorithm->declaration().parameters[tag.setting.number].name;
      child.refuse("parameter " + in_quotes(name) +
                       (lower_case(name) == lower_case(own_name) ? "" : ", which is " + std::string(own_name) + ",") +
                       " twice for the same joints",
                   "it once");
    }
    tags.push_back(tag);
  }
  return tags;
}

}  // namespace proleg::sim
