#include "sim/authoring/robot_change.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::sim {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

void check_name(const std::string& name) {
  if (name.empty() || !is_visible_line(name) || shortened(name) != name) {
    throw InputError("name", 0, in_quotes(one_line(name)), "1 to 60 characters that a person sees");
  }
}

}  // namespace

std::vector<ElementNumber> RobotChange::joints_from_the_end(JointMask joints) {
  const RobotElements all = find_robot_elements(change_, scenario_);
  std::vector<ElementNumber> found;
  for (const unsigned joint : joints) {
    if (joint >= scenario_.robot.joints.size()) {
      throw InputError("joint", 0, std::to_string(joint),
                       "a number below " + std::to_string(scenario_.robot.joints.size()));
    }
    const std::string& name = scenario_.robot.joints[joint].name;
    const auto element = all.joints.find(name);
    if (element == all.joints.end()) {
      throw InputError("joint", 0, in_quotes(name) + " in a file of its own",
                       "a joint of " + scenario_.robot_file + "; other robots may use that file, too");
    }
    found.push_back(element->second.joint);
  }
  if (found.empty()) {
    throw InputError("joints", 0, "no joint", "at least one");
  }
  std::ranges::sort(found, std::ranges::greater{});
  return found;
}

LinkElements RobotChange::link_elements(std::size_t link) {
  if (link >= scenario_.robot.links.size()) {
    throw InputError("link", 0, std::to_string(link), "a number below " + std::to_string(scenario_.robot.links.size()));
  }
  RobotElements all = find_robot_elements(change_, scenario_);
  const auto found = all.links.find(scenario_.robot.links[link].name);
  if (found == all.links.end()) {
    throw InputError("link", 0, in_quotes(scenario_.robot.links[link].name) + ", whose <Body> was not found",
                     "a link of the robot's files");
  }
  return std::move(found->second);
}

void RobotChange::set_number(JointMask joints, std::string_view tag, double value) {
  for (const ElementNumber joint : joints_from_the_end(joints)) {
    set_tag(change_, scenario_.robot_file, joint, tag, number_text_of(value));
  }
}

void RobotChange::set_axis(JointMask joints, const Eigen::Vector3d& axis) {
  for (const ElementNumber joint : joints_from_the_end(joints)) {
    set_tag(change_, scenario_.robot_file, joint, "axis", vector_text(axis));
  }
}

void RobotChange::set_limits(JointMask joints, double lower_degrees, double upper_degrees) {
  const std::string in_degrees = number_text_of(lower_degrees) + " " + number_text_of(upper_degrees);
  const std::string in_radians =
      number_text_of(lower_degrees * radians_per_degree) + " " + number_text_of(upper_degrees * radians_per_degree);
  for (const ElementNumber joint : joints_from_the_end(joints)) {
    if (xml().child(joint, "lostop")) {
      set_tag(change_, scenario_.robot_file, joint, "histop", number_text_of(upper_degrees));
      set_tag(change_, scenario_.robot_file, joint, "lostop", number_text_of(lower_degrees));
    } else if (const auto tag = xml().child(joint, "limitsdeg")) {
      change_.apply(scenario_.robot_file, xml().set_content(*tag, in_degrees));
    } else {
      const std::string_view present = xml().child(joint, "limitsrad") ? "limitsrad" : "limits";
      set_tag(change_, scenario_.robot_file, joint, present, in_radians);
    }
  }
}

void RobotChange::set_max_torque(JointMask joints, double newton_metres) {
  set_number(joints, "maxtorque", newton_metres);
}

void RobotChange::set_max_speed(JointMask joints, double radians_per_second) {
  for (const ElementNumber joint : joints_from_the_end(joints)) {
    const bool is_in_degrees = xml().child(joint, "maxveldeg").has_value();
    set_tag(change_, scenario_.robot_file, joint, is_in_degrees ? "maxveldeg" : "maxvel",
            number_text_of(is_in_degrees ? radians_per_second / radians_per_degree : radians_per_second));
  }
}

void RobotChange::rename_joint(unsigned joint, const std::string& name) {
  static_cast<void>(joints_from_the_end(JointMask::of(joint)));
  rename_joints({{scenario_.robot.joints[joint].name, name}});
}

void RobotChange::rename_joints(const std::map<std::string, std::string>& names) {
  const RobotElements all = find_robot_elements(change_, scenario_);
  std::vector<TextPatch> patches;
  for (const auto& [old_name, name] : names) {
    check_name(name);
    const auto found = all.joints.find(old_name);
    if (found == all.joints.end()) {
      throw InputError("joint", 0, in_quotes(old_name) + " in a file of its own",
                       "a joint of " + scenario_.robot_file + "; other robots may use that file, too");
    }
    const auto& [joint, prefix] = found->second;
    if (!name.starts_with(prefix) || name.size() == prefix.size()) {
      throw InputError("name", 0, in_quotes(name),
                       "a name that begins with " + in_quotes(prefix) + ", as its file has it");
    }
    patches.push_back(xml().set_attribute(joint, "name", name.substr(prefix.size())));
  }
  change_.apply_all(scenario_.robot_file, std::move(patches));
  replace_joint_names(change_, scenario_, names, false);
}

void RobotChange::rename(const std::string& name) {
  check_name(name);
  change_.apply(scenario_.robot_file, xml().set_attribute(0, "name", name));
}

void RobotChange::set_servo(std::string_view tag, double value) {
  const std::string& file = scenario_.robot_file;
  if (!xml().child(0, "servo")) {
    change_.apply(file, xml().add_first(0, "<servo>\n</servo>"));
  }
  set_tag(change_, file, xml().child(0, "servo").value(), tag, number_text_of(value));
}

void RobotChange::set_mass(std::size_t link, double mass) {
  const LinkElements own = link_elements(link);
  const std::optional<ElementNumber> element = change_.xml(own.file).child(own.body, "Mass");
  if (!element) {
    throw InputError("mass", 0, "link " + in_quotes(scenario_.robot.links[link].name) + " without a <Mass> of its own",
                     "a link that has one");
  }
  set_mass_of(change_, own.file, *element, mass);
}

void RobotChange::set_friction(std::size_t link, std::optional<double> friction) {
  const LinkElements own = link_elements(link);
  const std::vector<ElementNumber> geometries = change_.xml(own.file).children(own.body, "Geom");
  for (std::size_t i = geometries.size(); i-- > 0;) {
    set_friction_of(change_, own.file, geometries[i], friction);
  }
}

void replace_joint_names(DraftChange& change, const Scenario& scenario, const std::map<std::string, std::string>& names,
                         bool with_joints) {
  const auto new_name = [&names](const std::string& name) -> std::optional<std::string> {
    const auto found = names.find(name);
    return found == names.end() || found->second == name ? std::nullopt : std::optional(found->second);
  };
  const auto replace_in = [&](const std::string& file) {
    const XmlText& xml = change.xml(file);
    std::vector<TextPatch> patches;
    for (ElementNumber i = 0; i < xml.size(); ++i) {
      const bool names_joint = xml.is(i, "module") || xml.is(i, "parameter");
      const bool is_joint = xml.is(i, "Joint");
      const std::optional<ElementNumber> parent = xml.at(i).parent;
      if (is_joint && parent && xml.is(*parent, "AttachedSensor")) {
        if (const auto renamed = new_name(content_of(xml, i))) {
          patches.push_back(xml.set_content(i, *renamed));
        }
      } else if (names_joint || (is_joint && with_joints)) {
        const std::string_view attribute = is_joint ? "name" : "joint";
        if (const auto renamed = new_name(xml.attribute(i, attribute).value_or(""))) {
          patches.push_back(xml.set_attribute(i, attribute, *renamed));
        }
      }
    }
    change.apply_all(file, std::move(patches));
  };
  replace_in(scenario.robot_file);
  replace_in(scenario.actuation_file);
}

}  // namespace proleg::sim
