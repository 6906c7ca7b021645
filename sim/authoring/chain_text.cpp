#include "sim/authoring/chain_text.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"

namespace proleg::sim {
namespace {

[[noreturn]] void refuse(const XmlText& robot, ElementNumber element, const std::string& found) {
  throw InputError(robot.name(), robot.at(element).tag.line, found,
                   "a chain whose links stand beside each other in the robot's file, to change its length here");
}

ChainText::Link link_text(const XmlText& robot, const RobotElements& elements, const std::string& name) {
  const auto found = elements.links.find(name);
  if (found == elements.links.end() || !found->second.place) {
    refuse(robot, 0,
           "link " + in_quotes(name) +
               (found == elements.links.end() ? ", which is not in this file" : " in one <KinBody> with others"));
  }
  const LinkElements& link = found->second;
  const ElementNumber place = *link.place;
  if (!link.prefix.empty()) {
    refuse(robot, place, "the prefix " + in_quotes(link.prefix) + " around link " + in_quotes(name));
  }
  if (robot.child(place, "offsetfrom")) {
    refuse(robot, place, "link " + in_quotes(name) + " with <offsetfrom>");
  }
  return {name, link, place};
}

}  // namespace

ChainText read_chain_text(const Scenario& scenario, const XmlText& robot, const TextOf& text_of) {
  const RobotElements elements = find_robot_elements(robot, scenario.path, text_of);
  ChainText chain;
  for (std::size_t i = scenario.robot.links.size(); i-- > 0;) {
    chain.links.push_back(link_text(robot, elements, scenario.robot.links[i].name));
    if (robot.at(chain.links.back().place).parent != robot.at(chain.links.front().place).parent) {
      refuse(robot, chain.links.back().place, "link " + in_quotes(chain.links.back().name) + " in another <KinBody>");
    }
  }
  for (std::size_t i = scenario.robot.joints.size(); i-- > 0;) {
    const Joint& joint = scenario.robot.joints[i];
    const auto found = elements.joints.find(joint.name);
    if (found == elements.joints.end()) {
      refuse(robot, 0, "joint " + in_quotes(joint.name) + ", which is not in this file");
    }
    const ElementNumber element = found->second.joint;
    if (!found->second.prefix.empty()) {
      refuse(robot, element,
             "the prefix " + in_quotes(found->second.prefix) + " around joint " + in_quotes(joint.name));
    }
    const std::optional<ElementNumber> frame = robot.child(element, "offsetfrom");
    if (!frame) {
      refuse(robot, element, "joint " + in_quotes(joint.name) + " without <offsetfrom>");
    }
    const std::string body = content_of(robot, *frame);
    const std::string& rear = chain.links[chain.joints.size()].name;
    const std::string& front = chain.links[chain.joints.size() + 1].name;
    if (body != rear && body != front) {
      refuse(robot, element, "joint " + in_quotes(joint.name) + " in the frame of " + in_quotes(body));
    }
    chain.joints.push_back({joint.name, element, joint.file_index, body == rear});
  }
  return chain;
}

ChainText read_chain_text(DraftChange& change, const Scenario& scenario) {
  return read_chain_text(scenario, change.xml(scenario.robot_file),
                         [&change](const std::string& name) { return change.text(name); });
}

Eigen::Vector3d length_of_link(const Scenario& scenario, std::size_t link) {
  const std::vector<Joint>& joints = scenario.robot.joints;  // from the head
  const std::size_t front = joints.size() - 1 - link;
  return joints[front].anchor - joints[front + 1].anchor;
}

Eigen::Vector3d in_frame_around(const XmlText& robot, ElementNumber element, const Eigen::Vector3d& vector) {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  for (std::optional<ElementNumber> around = robot.at(element).parent; around; around = robot.at(*around).parent) {
    orientation = pose_of(robot, *around).orientation * orientation;
  }
  return orientation.conjugate() * vector;
}

void shift_links_in_front(DraftChange& change, const Scenario& scenario, const ChainText& chain, std::size_t behind,
                          const Eigen::Vector3d& shift) {
  const std::string& file = scenario.robot_file;
  const XmlText& xml = change.xml(file);
  std::vector<TextPatch> patches;
  for (std::size_t i = behind + 1; i < chain.links.size(); ++i) {
    const ElementNumber place = chain.links[i].place;
    const Eigen::Vector3d position = pose_of(xml, place).position + in_frame_around(xml, place, shift);
    const std::string text = vector_text(position);
    const std::vector<ElementNumber> translations = xml.children(place, "translation");
    if (translations.empty()) {
      patches.push_back(xml.add_first(place, element_text("translation", text)));
      continue;
    }
    patches.push_back(xml.set_content(translations.front(), text));
    for (std::size_t other = 1; other < translations.size(); ++other) {
      patches.push_back(xml.remove(translations[other]));
    }
  }
  change.apply_all(file, std::move(patches));
}

TextPatch link_name_patch(const XmlText& xml, ElementNumber place, const LinkElements& link, const std::string& name) {
  if (xml.is(place, "Body")) {
    return xml.set_attribute(place, "name", name);
  }
  if (!name.ends_with(link.body_name)) {
    throw InputError("link", 0, in_quotes(name),
                     "a name that ends with " + in_quotes(link.body_name) + ", as " + link.file + " has it");
  }
  const std::string prefix = name.substr(0, name.size() - link.body_name.size());
  const bool stays = prefix.empty() && !xml.attribute(place, "prefix");
  return stays ? TextPatch{} : xml.set_attribute(place, "prefix", prefix);
}

void replace_link_names(DraftChange& change, const std::string& file, const NewNames& names) {
  replace_link_names(change, file, 0, names);
}

void replace_link_names(DraftChange& change, const std::string& file, ElementNumber element, const NewNames& names) {
  const XmlText& xml = change.xml(file);
  std::vector<TextPatch> patches;
  for (ElementNumber i = element; i < xml.size() && xml.at(i).tag.begin < xml.at(element).end; ++i) {
    const std::optional<ElementNumber> parent = xml.at(i).parent;
    const bool is_in_sensor = parent && xml.is(*parent, "AttachedSensor");
    const bool is_in_joint = parent && xml.is(*parent, "Joint");
    const bool names_link = (is_in_joint && (xml.is(i, "body") || xml.is(i, "offsetfrom"))) ||
                            (is_in_sensor && xml.is(i, "link")) || xml.is(i, "adjacent");
    if (!names_link) {
      continue;
    }
    std::string replaced;
    const std::string content = content_of(xml, i);
    for (const std::string_view word : words(content)) {
      const auto found = names.find(std::string(word));
      replaced += (replaced.empty() ? "" : " ") + (found == names.end() ? std::string(word) : found->second);
    }
    if (replaced != content) {
      patches.push_back(xml.set_content(i, replaced));
    }
  }
  change.apply_all(file, std::move(patches));
}

std::string CountedNames::at(std::size_t position, std::size_t count) const {
  return before + std::to_string(from_the_end ? count - position : position + 1) + behind;
}

std::optional<CountedNames> counted_names(const std::vector<std::string>& names) {
  if (names.empty()) {
    return std::nullopt;
  }
  const std::string& name = names.front();
  for (const bool from_the_end : {false, true}) {
    const std::string first = std::to_string(from_the_end ? names.size() : 1);
    for (const bool is_last : {true, false}) {  // where the number is in the name
      const std::size_t at = is_last ? name.size() - std::min(name.size(), first.size()) : 0;
      if (!std::string_view(name).substr(at).starts_with(first)) {
        continue;
      }
      const CountedNames pattern{name.substr(0, at), name.substr(at + first.size()), from_the_end};
      std::size_t position = 0;
      if (std::ranges::all_of(
              names, [&](const std::string& other) { return other == pattern.at(position++, names.size()); })) {
        return pattern;
      }
    }
  }
  return std::nullopt;
}

}  // namespace proleg::sim
