#include "sim/authoring/robot_contents.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/chain_text.hpp"
#include "sim/authoring/module_kind.hpp"
#include "sim/authoring/scenario_text.hpp"

namespace proleg::sim {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

Eigen::Vector3d axis_in_file(const XmlText& xml, ElementNumber joint, const Eigen::Vector3d& otherwise) {
  const std::optional<ElementNumber> tag = xml.child(joint, "axis");
  if (!tag) {
    return otherwise;
  }
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  const std::string content = content_of(xml, *tag);
  const std::vector<std::string_view> numbers = words(content);
  for (std::size_t i = 0; i < numbers.size() && i < 3; ++i) {
    axis[static_cast<Eigen::Index>(i)] = parse_number(numbers[i]).value_or(0.0);
  }
  return axis;
}

}  // namespace

RobotContents read_robot_contents(const Draft& draft) {
  const Scenario& scenario = draft.scenario();
  const XmlText xml(scenario.robot_file, draft.text(scenario.robot_file));
  const TextOf text_of = [&draft](const std::string& name) { return draft.has(name) ? &draft.text(name) : nullptr; };
  const RobotElements elements = find_robot_elements(xml, scenario.path, text_of);
  RobotContents robot;
  robot.file = scenario.robot_file;
  for (const Joint& joint : scenario.robot.joints) {
    const auto found = elements.joints.find(joint.name);
    const bool is_editable = found != elements.joints.end();
    robot.joints.push_back({joint.name, is_editable,
                            is_editable ? axis_in_file(xml, found->second.joint, joint.axis) : joint.axis,
                            joint.lower_limit * degrees_per_radian, joint.upper_limit * degrees_per_radian,
                            joint.max_torque, joint.max_speed});
  }
  for (const Link& link : scenario.robot.links) {
    LinkContents contents{
        link.name, {}, 1, link.mass.mass, link.geometries.empty() ? std::nullopt : link.geometries.front().friction};
    if (const auto found = elements.links.find(link.name); found != elements.links.end()) {
      const LinkElements& own = found->second;
      contents.file = own.file;
      contents.same_count = static_cast<std::size_t>(std::ranges::count_if(elements.links, [&own](const auto& other) {
        return other.second.file == own.file && other.second.body == own.body;
      }));
    }
    robot.links.push_back(std::move(contents));
  }
  const std::vector<ElementNumber> attached = xml.children(0, "AttachedSensor");
  for (const AttachedSensor& sensor : scenario.robot.sensors) {
    const auto element = std::ranges::find_if(
        attached, [&](ElementNumber candidate) { return xml.attribute(candidate, "name") == sensor.name; });
    if (element != attached.end()) {
      robot.sensors.push_back({sensor,
                               sensor.kind == SensorKind::servo_current ? scenario.robot.joints[sensor.part].name
                                                                        : scenario.robot.links[sensor.part].name,
                               *element});
    }
  }
  for (const ModuleKind& kind : own_kinds(scenario)) {
    robot.kinds.push_back({kind.name, kind.length});
  }
  try {
    static_cast<void>(read_chain_text(scenario, xml, text_of));
  } catch (const InputError& error) {
    robot.obstacle = one_line(error.what());
  }
  return robot;
}

}  // namespace proleg::sim
