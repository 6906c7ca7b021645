#include "sim/authoring/joint_table.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/robot_change.hpp"

namespace proleg::sim {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> value_names{{{"axis", "axis"},
                                                                                    {"limits", "limits"},
                                                                                    {"limitsdeg", "limits"},
                                                                                    {"limitsrad", "limits"},
                                                                                    {"lostop", "limits"},
                                                                                    {"histop", "limits"},
                                                                                    {"maxtorque", "torque"},
                                                                                    {"maxvel", "speed"},
                                                                                    {"maxveldeg", "speed"}}};

int last_line(const XmlText& xml, ElementNumber element) { return line_at(xml.text(), xml.at(element).end - 1); }

/// What stands in a line of a joint: "torque of J3", or "J3" if several values, or none, are there.
std::string value_in_line(const XmlText& xml, ElementNumber joint, const std::string& name, int line) {
  std::string found;
  for (const ElementNumber child : xml.children(joint)) {
    const auto value = std::ranges::find_if(value_names, [&](const auto& tag) { return xml.is(child, tag.first); });
    if (value == value_names.end() || line < xml.at(child).tag.line || line > last_line(xml, child)) {
      continue;
    }
    if (!found.empty()) {
      return name;
    }
    found = std::string(value->second) + " of ";
  }
  return found + name;
}

/// The line of the robot's file that a message of the reader names, and the message behind it; nothing: it names none.
std::optional<std::pair<int, std::string>> line_of(const std::string& message, const std::string& file) {
  const std::string begin = file + ":";
  const std::size_t end = message.find(": ", begin.size());
  if (!message.starts_with(begin) || end == std::string::npos) {
    return std::nullopt;
  }
  const auto line = parse_number(std::string_view(message).substr(begin.size(), end - begin.size()));
  return line ? std::optional(std::pair(static_cast<int>(*line), message.substr(end + 2))) : std::nullopt;
}

/// Reads the scenario. A message about a joint names the joint and the value instead of a line of the file.
void require_readable(DraftChange& change, const Scenario& before) {
  try {
    static_cast<void>(change.scenario());
  } catch (const InputError& error) {
    const auto place = line_of(error.what(), before.robot_file);
    if (!place) {
      throw;
    }
    const XmlText& xml = change.xml(before.robot_file);
    std::string where;
    for (ElementNumber i = 0; i < xml.size(); ++i) {
      if (xml.is(i, "Joint") && place->first >= xml.at(i).tag.line && place->first <= last_line(xml, i)) {
        where = value_in_line(xml, i, xml.attribute(i, "name").value_or(""), place->first);
      }
    }
    if (where.empty()) {
      throw;
    }
    throw InputError(one_line(where) + ": " + place->second);
  }
}

}  // namespace

void set_joint_table(DraftChange& change, const std::vector<JointRow>& rows) {
  const Scenario before = change.scenario();
  RobotChange robot(before, change);
  JointMask seen;
  std::map<std::string, std::string> names;
  for (const JointRow& row : rows) {
    if (row.joint >= before.robot.joints.size() || seen.contains(row.joint)) {
      throw InputError("joint", 0, std::to_string(row.joint),
                       "each joint once, with a number below " + std::to_string(before.robot.joints.size()));
    }
    seen.insert(row.joint);
    const JointMask joint = JointMask::of(row.joint);
    if (row.axis) {
      robot.set_axis(joint, *row.axis);
    }
    if (row.limits) {
      robot.set_limits(joint, row.limits->first, row.limits->second);
    }
    if (row.torque) {
      robot.set_max_torque(joint, *row.torque);
    }
    if (row.speed) {
      robot.set_max_speed(joint, *row.speed);
    }
    if (row.name) {
      names.emplace(before.robot.joints[row.joint].name, *row.name);
    }
  }
  robot.rename_joints(names);
  require_readable(change, before);
}

}  // namespace proleg::sim
