#include "sim/scenario/robot_reader.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/chain.hpp"
#include "sim/scenario/kinbody_reader.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/plausibility.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t max_control_parameters = 1000;
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

/// Decimal, or hexadecimal after 0x.
std::optional<std::uint32_t> parse_node_or_serial(std::string_view text) {
  return text.starts_with("0x") || text.starts_with("0X") ? parse_whole<std::uint32_t>(text.substr(2), 16)
                                                          : parse_whole<std::uint32_t>(text);
}

/// A <module> and the kernel joint that it names.
struct ModuleEntry {
  XmlElement element;
  std::string joint_name;
  std::size_t joint;
  ModulePlace place;
};

ModuleEntry read_module(const XmlElement& element, const RobotModel& model) {
  element.allow({"joint", "node", "serial"}, {});
  const std::string name = element.required_attribute("joint");
  const int joint = find_joint(model, name);
  if (joint < 0) {
    element.refuse("unknown joint " + in_quotes(name), "one of " + listed(joint_names(model)));
  }
  ModuleEntry entry{element, name, static_cast<std::size_t>(joint), {}};
  const std::string node_text = element.required_attribute("node");
  const std::optional<std::uint32_t> node = parse_node_or_serial(node_text);
  if (!node || *node == 0 || *node > max_module_node) {
    element.refuse("node " + in_quotes(node_text) + " in " + element.label(),
                   "a whole number from 1 to " + std::to_string(max_module_node) + " (127 is the host)");
  }
  entry.place.node = static_cast<std::uint8_t>(*node);
  if (const auto serial_text = element.attribute("serial")) {
    const std::optional<std::uint32_t> serial = parse_node_or_serial(*serial_text);
    if (!serial || *serial == 0) {
      element.refuse("serial " + in_quotes(*serial_text) + " in " + element.label(),
                     "a whole number from 1 to 4294967295 (0xFFFFFFFF)");
    }
    entry.place.serial = serial;
  }
  return entry;
}

void check_against(const std::vector<ModuleEntry>& others, const ModuleEntry& entry) {
  for (const ModuleEntry& other : others) {
    const std::string where = "; the first is in line " + std::to_string(other.element.line());
    if (other.joint == entry.joint) {
      entry.element.refuse("a second module for joint " + in_quotes(entry.joint_name), "one" + where);
    }
    if (other.place.node == entry.place.node) {
      entry.element.refuse("a second module with node " + std::to_string(entry.place.node), "another node" + where);
    }
    if (entry.place.serial && other.place.serial == entry.place.serial) {
      entry.element.refuse("a second module with serial " + in_quotes(entry.element.required_attribute("serial")),
                           "another serial" + where);
    }
  }
}

constexpr Range gains{1e-3, 1e4, "1/s"};
constexpr Range servo_periods{0.1, 100.0, "ms"};
constexpr Range servo_latencies{0.0, 100.0, "ms"};

ServoModel read_servo(const XmlElement& element, double step_s) {
  element.allow({}, {"gain", "period", "commandspeed", "latency"});
  ServoModel servo;
  if (const auto gain = element.child("gain")) {
    servo.gain = read_quantity(*gain, gains);
    if (servo.gain * step_s > 1.0) {
      gain->refuse("a gain of " + number_text(servo.gain) + " 1/s with steps of " + number_text(step_s * 1e3) +
                       " ms, with which the servo overshoots in every step",
                   "at most " + number_text(1.0 / step_s) + " 1/s, or a smaller <stepWidth>");
    }
  }
  if (const auto period = element.child("period")) {
    servo.period_us = read_microseconds(*period, servo_periods);
  }
  if (const auto speed = element.child("commandspeed")) {
    servo.command_speed = static_cast<std::uint32_t>(read_whole(*speed, min_command_speed, max_command_speed));
  }
  if (const auto latency = element.child("latency")) {
    servo.latency_us = read_microseconds(*latency, servo_latencies);
  }
  return servo;
}

/// The pairs of <adjacent> that are no neighbours: they must not touch each other, and do.
std::vector<std::string> contact_warnings(const KinBodyContents& contents, const std::vector<Link>& links) {
  const auto place_of = [&](const std::string& body) { return std::ranges::find(links, body, &Link::name); };
  std::vector<std::string> warnings;
  for (const AdjacentBodies& adjacent : contents.adjacent) {
    const auto& [first, second] = adjacent.bodies;
    if (std::abs(place_of(first) - place_of(second)) > 1) {
      warnings.push_back(one_line(adjacent.origin.file + ":" + std::to_string(adjacent.origin.line) +
                                  ": <adjacent> has no effect: no joint joins " + in_quotes(first) + " and " +
                                  in_quotes(second) + ", so they touch each other"));
    }
  }
  return warnings;
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
    if (entry.parameters.size() == max_control_parameters) {
      child.refuse("more than " + std::to_string(max_control_parameters) + " parameters", "at most that many");
    }
    entry.parameters.push_back(parameter);
  }
  return entry;
}

std::vector<ModulePlace> read_modules(const XmlElement& robot, const RobotModel& model) {
  std::vector<ModuleEntry> entries;
  for (const XmlElement& child : robot.children()) {
    if (child.is("module")) {
      const ModuleEntry entry = read_module(child, model);
      check_against(entries, entry);
      entries.push_back(entry);
    }
  }

  std::vector<ModulePlace> places(model.joints.size());
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (entries.empty()) {
      places[j].node = static_cast<std::uint8_t>(j + 1);
      continue;
    }
    const auto entry = std::ranges::find(entries, j, &ModuleEntry::joint);
    if (entry == entries.end()) {
      robot.refuse("no <module> for joint " + in_quotes(model.joints[j].name) + " in " + robot.label(),
                   "a module for each joint, or none");
    }
    places[j] = entry->place;
  }
  return places;
}

RobotDescription read_robot(const XmlDocument& document, double step_s, SourceSet& sources,
                            std::vector<std::string>& remarks) {
  const XmlElement root = document.root("Robot");
  constexpr std::array<std::string_view, 6> extra_tags{"servo",          "module", "robot_control",
                                                       "AttachedSensor", "sensor", "Manipulator"};
  const KinBodyContents contents = read_kinbody(root, KinBodyUse::robot, sources, remarks, extra_tags);
  for (const XmlElement& child : root.children()) {
    if (child.is("sensor")) {
      remark_no_effect(remarks, child, "it is in no <AttachedSensor>");
    } else if (child.is("Manipulator")) {
      remark_no_effect(remarks, child, "a crawling robot has no manipulator");
    }
  }

  Chain chain = make_chain(contents, {document.name(), root.line()});
  RobotDescription robot;
  robot.model.name = root.attribute("name").value_or(document.path().stem().string());
  if (const auto servo = root.child("servo")) {
    robot.model.servo = read_servo(*servo, step_s);
  }
  robot.warnings = check_robot(chain);
  robot.contact_warnings = contact_warnings(contents, chain.links);
  if (robot.warnings.empty()) {  // bodies of a wrong size overlap, too
    std::ranges::move(check_overlaps(chain), std::back_inserter(robot.contact_warnings));
  }
  robot.model.links = std::move(chain.links);
  robot.model.joints = std::move(chain.joints);
  robot.kernel_limits = std::move(chain.kernel_limits);
  robot.model.sensors = read_sensors(root, robot.model, sources, remarks);
  robot.modules = read_modules(root, robot.model);
  robot.robot_control = read_robot_control(root, robot.model);
  remarks.push_back(one_line(chain.joint_map));
  return robot;
}

}  // namespace proleg::sim
