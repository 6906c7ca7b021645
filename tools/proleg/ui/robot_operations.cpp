#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/chain_change.hpp"
#include "sim/authoring/joint_table.hpp"
#include "sim/authoring/module_change.hpp"
#include "sim/authoring/module_kind.hpp"
#include "sim/authoring/robot_change.hpp"
#include "sim/authoring/sensor_change.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/draft_operations.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using sim::ChainChange;
using sim::DraftChange;
using sim::RobotChange;
using sim::SensorChange;

/// A change of parts that the robot has. The draft outlives the change.
DraftOperation parts(std::string label, const sim::Draft& draft, std::function<void(RobotChange&)> change) {
  return {std::move(label), [&draft, change = std::move(change)](DraftChange& edit) {
            RobotChange robot(draft.scenario(), edit);
            change(robot);
          }};
}

DraftOperation chain(std::string label, std::function<void(ChainChange&)> change) {
  return {std::move(label),
          [change = std::move(change)](DraftChange& edit) {
            ChainChange changed(edit);
            change(changed);
          },
          true};
}

DraftOperation sensors(std::string label, const sim::Draft& draft, bool moves_positions,
                       std::function<void(SensorChange&)> change) {
  return {std::move(label),
          [&draft, change = std::move(change)](DraftChange& edit) {
            const sim::RobotContents contents = read_robot_contents(draft);
            SensorChange changed(draft.scenario(), contents, edit);
            change(changed);
          },
          moves_positions};
}

std::size_t joint_count(const sim::Draft& draft) { return draft.scenario().robot.joints.size(); }

/// "J3", or "2 joints".
std::string joints_name(JointMask joints, const sim::Draft& draft) {
  return joints.size() == 1 && joints.front() < joint_count(draft) ? draft.scenario().robot.joints[joints.front()].name
                                                                   : std::to_string(joints.size()) + " joints";
}

/// The position from the tail of a joint in kernel order. One that does not exist gives one that does not exist.
std::size_t from_tail(std::size_t joint, const sim::Draft& draft) {
  return joint < joint_count(draft) ? joint_count(draft) - 1 - joint : joint;
}

DraftOperation axis(const json& words, const sim::Draft& draft) {
  return parts(
      "axis of " + joints_name(joints(words), draft), draft,
      [joints = joints(words), value = vector(words, "value")](RobotChange& robot) { robot.set_axis(joints, value); });
}

DraftOperation limits(const json& words, const sim::Draft& draft) {
  return parts("limits of " + joints_name(joints(words), draft), draft,
               [joints = joints(words), lower = number(words, "lower"),
                upper = number(words, "upper")](RobotChange& robot) { robot.set_limits(joints, lower, upper); });
}

DraftOperation torque(const json& words, const sim::Draft& draft) {
  return parts("torque of " + joints_name(joints(words), draft), draft,
               [joints = joints(words), value = number(words, "value")](RobotChange& robot) {
                 robot.set_max_torque(joints, value);
               });
}

DraftOperation speed(const json& words, const sim::Draft& draft) {
  return parts("speed of " + joints_name(joints(words), draft), draft,
               [joints = joints(words), value = number(words, "value")](RobotChange& robot) {
                 robot.set_max_speed(joints, value);
               });
}

DraftOperation rename_joint(const json& words, const sim::Draft& draft) {
  return parts("rename joint", draft,
               [joint = position_of(words, "joint"), name = text(words, "name")](RobotChange& robot) {
                 robot.rename_joint(static_cast<unsigned>(joint), name);
               });
}

std::optional<Eigen::Vector3d> optional_vector(const json& words, const char* name) {
  return words.contains(name) ? std::optional(vector(words, name)) : std::nullopt;
}

/// An entry of the argument `joints` of robot.table.
sim::JointRow joint_row(const json& words) {
  if (!words.is_object()) {
    throw InputError("joints", 0, "no object", "an object for each joint");
  }
  sim::JointRow row;
  row.joint = static_cast<unsigned>(position_of(words, "joint"));
  row.name = argument<std::string>(words, "name", "a text");
  row.axis = optional_vector(words, "axis");
  if (words.contains("limits")) {
    const std::vector<double> given = numbers(words, "limits");
    if (given.size() != 2) {
      throw InputError("limits", 0, std::to_string(given.size()) + " numbers", "two numbers, the lower limit first");
    }
    row.limits = {given[0], given[1]};
  }
  row.torque = argument<double>(words, "torque", "a number");
  row.speed = argument<double>(words, "speed", "a number");
  return row;
}

/// Values of several joints; before that the chain gets `count` joints, if that is there.
DraftOperation table(const json& words, const sim::Draft& /*draft*/) {
  const json given = words.value("joints", json());
  if (!given.is_array() || given.size() > max_joints) {
    throw InputError("joints", 0, given.is_array() ? std::to_string(given.size()) + " entries" : "no list",
                     "a list of at most " + std::to_string(max_joints) + " joints");
  }
  std::vector<sim::JointRow> rows;
  for (const json& entry : given) {
    rows.push_back(joint_row(entry));
  }
  const auto count = argument<std::uint32_t>(words, "count", "a number of joints");
  return {"table of joints",
          [rows = std::move(rows), count](DraftChange& edit) {
            if (count) {
              ChainChange(edit).set_joint_count(*count);
            }
            set_joint_table(edit, rows);
          },
          count.has_value()};
}

DraftOperation rename(const json& words, const sim::Draft& draft) {
  return parts("rename robot", draft, [name = text(words, "name")](RobotChange& robot) { robot.rename(name); });
}

DraftOperation servo(const json& words, const sim::Draft& draft) {
  static const std::map<std::string_view, std::string_view> tags{
      {"gain", "gain"}, {"period", "period"}, {"command_speed", "commandspeed"}, {"latency", "latency"}};
  const std::string name = text(words, "name");
  const auto tag = tags.find(name);
  if (tag == tags.end()) {
    throw InputError("name", 0, in_quotes(name), "'gain', 'period', 'command_speed' or 'latency'");
  }
  return parts("servo " + name, draft, [tag = tag->second, value = number(words, "value")](RobotChange& robot) {
    robot.set_servo(tag, value);
  });
}

DraftOperation mass(const json& words, const sim::Draft& draft) {
  return parts("mass of a link", draft,
               [link = position_of(words, "link"), value = number(words, "value")](RobotChange& robot) {
                 robot.set_mass(link, value);
               });
}

DraftOperation friction(const json& words, const sim::Draft& draft) {
  return parts("friction of a link", draft,
               [link = position_of(words, "link"), value = argument<double>(words, "value", "a number, or null")](
                   RobotChange& robot) { robot.set_friction(link, value); });
}

DraftOperation duplicate_joint(const json& words, const sim::Draft& draft) {
  return chain("add joint", [joint = from_tail(position_of(words, "joint"), draft)](ChainChange& changed) {
    changed.duplicate(joint);
  });
}

DraftOperation remove_joint(const json& words, const sim::Draft& draft) {
  return chain("delete joint", [joint = from_tail(position_of(words, "joint"), draft)](ChainChange& changed) {
    changed.remove(joint);
  });
}

DraftOperation count(const json& words, const sim::Draft& /*draft*/) {
  const std::size_t value = position_of(words, "value");
  return chain(std::to_string(value) + " joints", [value](ChainChange& changed) { changed.set_joint_count(value); });
}

/// Kernel joint i becomes what kernel joint order[i] was.
DraftOperation order(const json& words, const sim::Draft& draft) {
  const std::vector<std::size_t> given = positions(words, "order");
  std::vector<std::size_t> counted;
  for (auto joint = given.rbegin(); joint != given.rend(); ++joint) {
    counted.push_back(from_tail(*joint, draft));
  }
  return chain("order of joints", [counted](ChainChange& changed) { changed.order(counted); });
}

DraftOperation move_joint(const json& words, const sim::Draft& draft) {
  return chain("move joint",
               [from = from_tail(position_of(words, "joint"), draft),
                to = from_tail(position_of(words, "to"), draft)](ChainChange& changed) { changed.move(from, to); });
}

sim::ModuleKind kind_named(const std::string& name, const sim::Draft& draft) {
  if (const sim::RobotKind* const known = sim::find_robot_kind(name)) {
    return module_kind(*known);
  }
  for (sim::ModuleKind& own : sim::own_kinds(draft.scenario())) {
    if (own.name == name) {
      return std::move(own);
    }
  }
  throw InputError("kind", 0, in_quotes(name), "a kind of the document `parts`, or one of the draft");
}

DraftOperation kind(const json& words, const sim::Draft& draft) {
  const std::string name = text(words, "kind");
  auto found = std::make_shared<const sim::ModuleKind>(kind_named(name, draft));
  const auto link = argument<std::uint32_t>(words, "link", "a position in the list, or null for all links");
  return {"modules " + name,
          [found, links = links_from_tail(link ? std::vector<std::size_t>{*link} : std::vector<std::size_t>{}, draft)](
              DraftChange& edit) { sim::set_kind_of_links(edit, *found, links); },
          true};
}

sim::SensorKind sensor_kind(const std::string& name) {
  for (const sim::SensorKind kind : {sim::SensorKind::touch, sim::SensorKind::laser, sim::SensorKind::servo_current,
                                     sim::SensorKind::inclinometer, sim::SensorKind::accelerometer}) {
    if (name_of(kind) == name) {
      return kind;
    }
  }
  throw InputError("kind", 0, in_quotes(name), "a kind of sensor of the document `parts`");
}

DraftOperation add_sensor(const json& words, const sim::Draft& draft) {
  const std::string name = argument<std::string>(words, "place", "a word").value_or("front");
  const std::vector<std::string_view>& places = sim::sensor_places();
  const auto place = std::ranges::find(places, name);
  if (place == places.end()) {
    throw InputError("place", 0, in_quotes(name), "'front', 'rear', 'left', 'right', 'above' or 'below'");
  }
  const sim::SensorKind added = sensor_kind(text(words, "kind"));
  return sensors(
      "add " + std::string(name_of(added)), draft, true,
      [added, part = position_of(words, "part"), side = static_cast<sim::SensorPlace>(place - places.begin())](
          SensorChange& changed) { changed.add(added, part, side); });
}

DraftOperation remove_sensor(const json& words, const sim::Draft& draft) {
  return sensors("delete sensor", draft, true,
                 [sensor = position_of(words, "sensor")](SensorChange& changed) { changed.remove(sensor); });
}

DraftOperation rename_sensor(const json& words, const sim::Draft& draft) {
  return sensors("rename sensor", draft, false,
                 [sensor = position_of(words, "sensor"), name = text(words, "name")](SensorChange& changed) {
                   changed.rename(sensor, name);
                 });
}

DraftOperation place_sensor(const json& words, const sim::Draft& draft) {
  return sensors("move sensor", draft, false,
                 [sensor = position_of(words, "sensor"), placed = pose(words)](SensorChange& changed) {
                   changed.place(sensor, placed);
                 });
}

DraftOperation sensor_part(const json& words, const sim::Draft& draft) {
  return sensors("move sensor", draft, false,
                 [sensor = position_of(words, "sensor"), part = position_of(words, "part")](SensorChange& changed) {
                   changed.set_part(sensor, part);
                 });
}

/// The properties of a sensor that a person may set, by the tags of the file.
DraftOperation set_sensor(const json& words, const sim::Draft& draft) {
  static const std::vector<std::string> tags{"extents",    "input",    "minangle", "maxangle",
                                             "resolution", "maxrange", "scantime"};
  const std::string name = text(words, "name");
  if (std::ranges::find(tags, name) == tags.end()) {
    throw InputError("name", 0, in_quotes(name), "one of " + listed(tags));
  }
  return sensors("sensor " + name, draft, false,
                 [sensor = position_of(words, "sensor"), name, value = text(words, "value")](SensorChange& changed) {
                   changed.set_property(sensor, name, value);
                 });
}

}  // namespace

DraftOperation robot_operation(const std::string& name, const json& arguments, const sim::Draft& draft) {
  using Reader = DraftOperation (*)(const json&, const sim::Draft&);
  static const std::map<std::string_view, Reader> readers{{"robot.axis", axis},
                                                          {"robot.limits", limits},
                                                          {"robot.torque", torque},
                                                          {"robot.speed", speed},
                                                          {"robot.rename_joint", rename_joint},
                                                          {"robot.rename", rename},
                                                          {"robot.table", table},
                                                          {"robot.servo", servo},
                                                          {"robot.mass", mass},
                                                          {"robot.friction", friction},
                                                          {"robot.duplicate", duplicate_joint},
                                                          {"robot.remove", remove_joint},
                                                          {"robot.count", count},
                                                          {"robot.order", order},
                                                          {"robot.move", move_joint},
                                                          {"robot.kind", kind},
                                                          {"robot.add_sensor", add_sensor},
                                                          {"robot.remove_sensor", remove_sensor},
                                                          {"robot.rename_sensor", rename_sensor},
                                                          {"robot.place_sensor", place_sensor},
                                                          {"robot.sensor_part", sensor_part},
                                                          {"robot.set_sensor", set_sensor}};
  return handler_of(readers, name)(arguments, draft);
}

}  // namespace proleg::tools
