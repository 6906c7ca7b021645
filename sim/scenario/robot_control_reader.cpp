#include "sim/scenario/robot_control_reader.hpp"

#include <algorithm>
#include <string>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t max_parameters = 1000;
constexpr std::size_t max_value_size = 4096;

RobotControlEntry::Parameter read_parameter(const XmlElement& element, const RobotModel& model) {
  element.allow({"name", "value", "joint"}, {});
  RobotControlEntry::Parameter parameter;
  parameter.name = checked_name(element, element.required_attribute("name"));
  parameter.value = element.required_attribute("value");
  parameter.line = element.line();
  if (parameter.value.size() > max_value_size) {
    element.refuse("a value of " + std::to_string(parameter.value.size()) + " bytes in " + element.label(),
                   "at most " + std::to_string(max_value_size));
  }
  if (const auto name = element.attribute("joint")) {
    const int joint = find_joint(model, *name);
    if (joint < 0) {
      element.refuse("unknown joint " + in_quotes(*name), "one of " + listed(joint_names(model)));
    }
    parameter.joint = static_cast<std::uint32_t>(joint);
  }
  return parameter;
}

}  // namespace

std::optional<RobotControlEntry> read_robot_control(const XmlElement& robot, const RobotModel& model) {
  const auto element = robot.child("robot_control");
  if (!element) {
    return std::nullopt;
  }
  element->allow({"plugin"}, {"parameter"});
  RobotControlEntry entry;
  entry.plugin = element->required_attribute("plugin");
  if (trimmed(entry.plugin).empty()) {
    element->refuse("an empty plugin in " + element->label(), "the name of a plug-in, such as dynamixel, or its path");
  }
  entry.file = element->document().name();
  entry.folder = element->document().path().parent_path().string();
  entry.line = element->line();
  for (const XmlElement& child : element->children()) {
    const RobotControlEntry::Parameter parameter = read_parameter(child, model);
    const auto first = std::ranges::find_if(entry.parameters, [&](const RobotControlEntry::Parameter& other) {
      return other.name == parameter.name && other.joint == parameter.joint;
    });
    if (first != entry.parameters.end()) {
      child.refuse("a second parameter " + in_quotes(parameter.name) +
                       (parameter.joint ? " for joint " + in_quotes(model.joints[*parameter.joint].name) : ""),
                   "one; the first is in line " + std::to_string(first->line));
    }
    if (entry.parameters.size() == max_parameters) {
      child.refuse("more than " + std::to_string(max_parameters) + " parameters", "at most that many");
    }
    entry.parameters.push_back(parameter);
  }
  return entry;
}

}  // namespace proleg::sim
