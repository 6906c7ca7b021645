#include "sim/authoring/behaviour_change.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/authoring/actuation_edit.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

const Declaration& declaration_of(const std::string& algorithm) {
  const ActuationModule* const found = find_algorithm(algorithm);
  if (found == nullptr) {
    throw InputError("algorithm", 0, in_quotes(algorithm),
                     "the name of an algorithm, as 'proleg algorithms' lists them");
  }
  return found->declaration();
}

/// Whether an algorithm takes a <parameter> as it stands in the file.
bool takes(const Declaration& declaration, const XmlText& xml, ElementNumber element) {
  const int number = find_named_parameter(declaration, xml.attribute(element, "name").value_or(""));
  if (number < 0) {
    return false;
  }
  const Parameter& parameter = declaration.parameters[static_cast<unsigned>(number)];
  const std::optional<std::string> unit = xml.attribute(element, "unit");
  if (unit && *unit != scale_of(parameter.unit).symbol) {
    return false;
  }
  try {
    static_cast<void>(parse_parameter(parameter, xml.attribute(element, "value").value_or(""), xml.name(), 0));
  } catch (const InputError&) {  // out of the range
    return false;
  }
  return true;
}

}  // namespace

std::string joints_text(const RobotModel& robot, JointMask joints) {
  std::string text(robot.joints.size(), '0');
  for (const unsigned joint : joints) {
    text[robot.joints[joint].file_index] = '1';
  }
  return text;
}

int joint_of_parameter(const XmlText& xml, ElementNumber parameter, const RobotModel& robot) {
  if (const auto name = xml.attribute(parameter, "joint")) {
    return find_joint(robot, *name);
  }
  return find_joint_of_thesis(robot, xml.attribute(parameter, "name").value_or(""));
}

ElementNumber BehaviourChange::module_of(unsigned slot) {
  const std::vector<ElementNumber> modules = xml().children(0, "actuationModule");
  if (slot >= modules.size()) {
    throw InputError("module", 0, std::to_string(slot + 1), "1 to " + std::to_string(modules.size()));
  }
  return modules[slot];
}

void BehaviourChange::check_joints(JointMask joints) const {
  const auto count = static_cast<unsigned>(scenario_.robot.joints.size());
  if (const JointMask unknown = joints - JointMask::first(count); !unknown.empty()) {
    throw InputError("joints", 0, "joint " + std::to_string(unknown.front()), "joints below " + std::to_string(count));
  }
}

void BehaviourChange::write_joints(ElementNumber module, JointMask joints) {
  const ElementNumber element = xml().child(module, "jointConfiguration").value();
  apply(xml().set_attribute(element, "joints", joints_text(scenario_.robot, joints)));
}

void BehaviourChange::add(const std::string& algorithm, JointMask joints) {
  check_joints(joints);
  const std::string lines = "<actuationModule name=\"" + escaped_xml(declaration_of(algorithm).name) +
                            "\">\n  <jointConfiguration joints=\"" + joints_text(scenario_.robot, joints) +
                            "\"/>\n</actuationModule>";
  const std::vector<ElementNumber> modules = xml().children(0, "actuationModule");
  apply(modules.empty() ? xml().add_last(0, lines) : xml().add_behind(modules.back(), lines));
}

void BehaviourChange::duplicate(unsigned slot, JointMask joints) {
  check_joints(joints);
  const ElementNumber module = module_of(slot);
  const std::string lines = unindented(xml(), module);
  apply(xml().add_behind(module, lines));
  const ElementNumber copy = next_sibling(xml(), module);
  const std::vector<ElementNumber> parameters = xml().children(copy, "parameter");
  for (std::size_t i = parameters.size(); i-- > 0;) {
    if (joint_of_parameter(xml(), parameters[i], scenario_.robot) >= 0) {
      apply(xml().remove(parameters[i]));
    }
  }
  write_joints(copy, joints);
}

void BehaviourChange::remove(unsigned slot) { apply(xml().remove(module_of(slot))); }

void BehaviourChange::set_algorithm(unsigned slot, const std::string& algorithm) {
  const Declaration& declaration = declaration_of(algorithm);
  const ElementNumber module = module_of(slot);
  const std::vector<ElementNumber> parameters = xml().children(module, "parameter");
  for (std::size_t i = parameters.size(); i-- > 0;) {
    if (!takes(declaration, xml(), parameters[i])) {
      apply(xml().remove(parameters[i]));
    }
  }
  apply(xml().set_attribute(module, "name", declaration.name));
}

void BehaviourChange::set_joints(unsigned slot, JointMask joints) {
  check_joints(joints);
  const ElementNumber module = module_of(slot);
  const std::vector<ElementNumber> parameters = xml().children(module, "parameter");
  for (std::size_t i = parameters.size(); i-- > 0;) {
    const int joint = joint_of_parameter(xml(), parameters[i], scenario_.robot);
    if (joint >= 0 && !joints.contains(static_cast<unsigned>(joint))) {
      apply(xml().remove(parameters[i]));
    }
  }
  write_joints(module, joints);
}

void BehaviourChange::set_start_values(Scenario& wanted, const Value& value) {
  static_cast<void>(module_of(value.slot));
  const Slot& used = scenario_.kernel.slots[value.slot];
  const Declaration& declaration = used.algorithm->declaration();
  const int number = find_parameter(declaration, value.parameter);
  if (number < 0) {
    throw InputError("parameter", 0, in_quotes(value.parameter), "one of " + listed(parameter_names(declaration)));
  }
  if (value.joints.empty() || !(value.joints - used.group).empty()) {
    throw InputError("joints", 0, value.joints.empty() ? "no joint" : "a joint that the module does not move",
                     "joints of the module");
  }
  const std::int32_t raw =
      parse_parameter(declaration.parameters[static_cast<unsigned>(number)], value.text, value.parameter, 0);
  for (const unsigned joint : value.joints) {
    set_start_value(wanted, {static_cast<std::uint8_t>(value.slot), static_cast<std::uint8_t>(joint),
                             static_cast<std::uint8_t>(number), false, raw});
  }
}

void BehaviourChange::set_values(const std::vector<Value>& values) {
  Scenario wanted = scenario_;
  for (const Value& value : values) {
    set_start_values(wanted, value);
  }
  const std::vector<ActuationEdit> edits = actuation_edits(scenario_, wanted);
  for (const ActuationEdit* edit : from_the_end(edits)) {
    apply(edit->patch);
  }
}

}  // namespace proleg::sim
