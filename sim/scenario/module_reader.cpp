#include "sim/scenario/module_reader.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::sim {
namespace {

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

}  // namespace

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

}  // namespace proleg::sim
