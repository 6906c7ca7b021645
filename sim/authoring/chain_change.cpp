#include "sim/authoring/chain_change.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/behaviour_change.hpp"
#include "sim/authoring/chain_text.hpp"
#include "sim/authoring/robot_change.hpp"
#include "sim/authoring/scenario_text.hpp"

namespace proleg::sim {
namespace {

/// What a joint is, beside the links that it joins and its place.
constexpr std::array<std::string_view, 13> property_tags{"axis",     "limitsdeg",  "limits", "limitsrad", "lostop",
                                                         "histop",   "maxtorque",  "maxvel", "maxveldeg", "hardmaxvel",
                                                         "maxaccel", "resolution", "weight"};

template <typename Part>
std::vector<std::string> names_of(const std::vector<Part>& parts) {
  std::vector<std::string> names;
  names.reserve(parts.size());
  for (const Part& part : parts) {
    names.push_back(part.name);
  }
  return names;
}

/// The names of the links between two joints.
std::vector<std::string> without_ends(const std::vector<std::string>& links) {
  return links.size() < 3 ? std::vector<std::string>{} : std::vector<std::string>(links.begin() + 1, links.end() - 1);
}

std::string free_name(const std::vector<std::string>& taken, const CountedNames& pattern) {
  std::string name;
  std::size_t number = taken.size();
  do {
    name = pattern.before + std::to_string(number++) + pattern.behind;
  } while (std::ranges::find(taken, name) != taken.end());
  return name;
}

std::string without_number(const std::string& name) { return name.substr(0, name.find_last_not_of("0123456789") + 1); }

/// The elements of a kind, the last one first: an edit does not move the elements before it.
std::vector<ElementNumber> from_the_end(const XmlText& xml, std::string_view tag) {
  std::vector<ElementNumber> elements;
  for (ElementNumber i = xml.size(); i-- > 0;) {
    if (xml.is(i, tag)) {
      elements.push_back(i);
    }
  }
  return elements;
}

/// 0, 1, 2, ...
std::vector<std::size_t> present_order(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

/// What each position gets when the part at one position goes to another one.
std::vector<std::size_t> moved_order(std::size_t count, std::size_t from, std::size_t to) {
  std::vector<std::size_t> order = present_order(count);
  order.erase(order.begin() + static_cast<std::ptrdiff_t>(from));
  order.insert(order.begin() + static_cast<std::ptrdiff_t>(to), from);
  return order;
}

}  // namespace

struct ChainChange::State {
  Scenario scenario;
  ChainText chain;

  [[nodiscard]] const std::string& file() const { return scenario.robot_file; }
  [[nodiscard]] std::size_t joint_count() const { return chain.joints.size(); }
  [[nodiscard]] const Eigen::Vector3d& axis(std::size_t joint) const {
    return scenario.robot.joints[joint_count() - 1 - joint].axis;
  }
};

ChainChange::State ChainChange::read() {
  State state{change_.scenario(), {}};
  state.chain = read_chain_text(change_, state.scenario);
  const XmlText& actuation = change_.xml(state.scenario.actuation_file);
  for (const ElementNumber parameter : from_the_end(actuation, "parameter")) {
    if (!actuation.attribute(parameter, "joint") &&
        joint_of_parameter(actuation, parameter, state.scenario.robot) >= 0) {
      throw InputError(actuation.name(), actuation.at(parameter).tag.line,
                       "a value that names its joint by the position, " +
                           in_quotes(actuation.attribute(parameter, "name").value_or("")),
                       "values with the attribute joint=, to change the chain here");
    }
  }
  return state;
}

void ChainChange::duplicate(std::size_t joint) {
  const State state = read();
  const std::size_t count = state.joint_count();
  if (joint >= count) {
    throw InputError("joint", 0, std::to_string(joint), "a number below " + std::to_string(count));
  }
  if (count == 1) {
    throw InputError("joint", 0, "a robot with one joint", "a link between two joints, to copy it");
  }
  if (joint + 1 < count) {
    duplicate_link(state, joint + 1);
    return;
  }
  duplicate_link(state, joint);
  std::vector<std::size_t> source = present_order(count + 1);
  source[joint] = count;
  assign(read(), source);
}

void ChainChange::remove(std::size_t joint) {
  State state = read();
  const std::size_t count = state.joint_count();
  if (joint >= count) {
    throw InputError("joint", 0, std::to_string(joint), "a number below " + std::to_string(count));
  }
  if (count == 1) {
    throw InputError("joint", 0, "the only joint of the robot", "a robot with at least two, to remove one");
  }
  if (joint + 1 == count) {
    std::vector<std::size_t> source = present_order(count);
    std::swap(source[joint - 1], source[joint]);
    assign(state, source);
    state = read();
    --joint;
  }
  remove_link(std::move(state), joint + 1);
}

void ChainChange::set_joint_count(std::size_t count) {
  if (count < 1 || count > max_joints) {
    throw InputError("joints", 0, std::to_string(count), "1 to " + std::to_string(max_joints));
  }
  std::size_t present = read().joint_count();
  for (; present > count; --present) {
    remove(present - 1);
  }
  for (; present < count; ++present) {
    duplicate(present - 1);
    const State state = read();
    // Before: ..., a, b. Now: ..., a, b, b. Where a and b differ, the new joint is to be an a.
    constexpr double same_axis = 1e-6;
    if (present >= 2 && (state.axis(present - 2) - state.axis(present)).norm() > same_axis) {
      std::vector<std::size_t> source = present_order(present + 1);
      source[present] = present - 2;
      assign(state, source);
    }
  }
}

void ChainChange::order(const std::vector<std::size_t>& order) {
  const State state = read();
  std::vector<std::size_t> sorted = order;
  std::ranges::sort(sorted);
  if (sorted != present_order(state.joint_count())) {
    throw InputError("order", 0, std::to_string(order.size()) + " numbers",
                     "the numbers from 0 to " + std::to_string(state.joint_count() - 1) + ", each once");
  }
  assign(state, order);
}

void ChainChange::move(std::size_t from, std::size_t to) {
  const State state = read();
  const std::size_t count = state.joint_count();
  if (from >= count || to >= count) {
    throw InputError("joint", 0, std::to_string(std::max(from, to)), "a number below " + std::to_string(count));
  }
  assign(state, moved_order(count, from, to));
  if (count > 2) {
    move_link(std::min(from, count - 2) + 1, std::min(to, count - 2) + 1);
  }
}

void ChainChange::move_link(std::size_t from, std::size_t to) {
  State state = read();
  const std::size_t first = std::min(from, to);
  const std::size_t last = std::max(from, to);
  struct Module {
    std::string file;
    std::string body;
    double length;  // m
  };
  std::vector<Module> modules;
  for (std::size_t i = 0; i < state.chain.links.size(); ++i) {
    const bool is_moved = i >= first && i <= last;
    const ChainText::Link& link = state.chain.links[i];
    const auto file = change_.xml(state.file()).attribute(link.place, "file");
    if (is_moved && (!file || state.chain.joints[i - 1].is_framed_by_rear || state.chain.joints[i].is_framed_by_rear)) {
      return;
    }
    modules.push_back(
        {file.value_or(""), link.elements.body_name, is_moved ? length_of_link(state.scenario, i).norm() : 0.0});
  }
  const std::vector<std::size_t> source = moved_order(modules.size(), from, to);
  for (std::size_t i = first; i <= last; ++i) {
    const Module& module = modules[source[i]];
    if (module.file == modules[i].file && module.body == modules[i].body) {
      continue;
    }
    state = read();
    const ChainText::Link& old = state.chain.links[i];
    const Eigen::Vector3d length = length_of_link(state.scenario, i);
    shift_links_in_front(change_, state.scenario, state.chain, i, length.normalized() * module.length - length);
    const ElementNumber place = find_robot_elements(change_, state.scenario).links.at(old.name).place.value();
    change_.apply(state.file(), change_.xml(state.file()).set_attribute(place, "file", module.file));
    const std::string prefix = change_.xml(state.file()).attribute(place, "prefix").value_or("");
    if (const std::string name = prefix + module.body; name != old.name) {
      replace_link_names(change_, state.file(), {{old.name, name}});
    }
  }
  state = read();
  NewNames places;
  for (std::size_t i = first; i <= last; ++i) {
    places[state.chain.links[source[i]].name] = state.chain.links[i].name;
  }
  move_sensors(state, places);
}

void ChainChange::move_sensors(const State& state, const NewNames& links) {
  const XmlText& xml = change_.xml(state.file());
  std::vector<TextPatch> patches;
  for (ElementNumber i = 0; i < xml.size(); ++i) {
    const std::optional<ElementNumber> parent = xml.at(i).parent;
    if (!xml.is(i, "link") || !parent || !xml.is(*parent, "AttachedSensor")) {
      continue;
    }
    if (const auto place = links.find(content_of(xml, i)); place != links.end() && place->second != place->first) {
      patches.push_back(xml.set_content(i, place->second));
    }
  }
  change_.apply_all(state.file(), std::move(patches));
}

void ChainChange::assign(const State& state, const std::vector<std::size_t>& source) {
  assign_properties(state, source);
  edit_masks(state, [&](std::string& mask) {
    const std::string before = mask;
    for (std::size_t i = 0; i < source.size(); ++i) {
      mask[state.chain.joints[i].file_index] = before[state.chain.joints[source[i]].file_index];
    }
  });
  std::vector<std::size_t> sorted = source;
  std::ranges::sort(sorted);
  if (sorted == present_order(source.size())) {
    NewNames names;
    for (std::size_t i = 0; i < source.size(); ++i) {
      names[state.chain.joints[source[i]].name] = state.chain.joints[i].name;
    }
    replace_joint_names(change_, state.scenario, names, false);
  } else {
    assign_values(state, source);
  }
}

void ChainChange::assign_properties(const State& state, const std::vector<std::size_t>& source) {
  using Properties = std::map<std::string_view, std::string>;
  std::vector<Properties> properties(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    const XmlText& xml = change_.xml(state.file());
    for (const std::string_view tag : property_tags) {
      if (const auto child = xml.child(state.chain.joints[i].element, tag)) {
        properties[i][tag] = content_of(xml, *child);
      }
    }
  }
  std::vector<std::size_t> joints = present_order(source.size());
  std::ranges::sort(joints, std::ranges::greater{}, [&](std::size_t i) { return state.chain.joints[i].element; });
  for (const std::size_t joint : joints) {
    const ElementNumber element = state.chain.joints[joint].element;
    const Properties& wanted = properties[source[joint]];
    if (wanted == properties[joint]) {
      continue;
    }
    for (const std::string_view tag : property_tags) {
      const auto value = wanted.find(tag);
      if (value != wanted.end()) {
        set_tag(change_, state.file(), element, tag, value->second);
      } else if (const auto child = change_.xml(state.file()).child(element, tag)) {
        change_.apply(state.file(), change_.xml(state.file()).remove(*child));
      }
    }
  }
}

void ChainChange::assign_values(const State& state, const std::vector<std::size_t>& source) {
  const std::string& file = state.scenario.actuation_file;
  for (const ElementNumber parameter : from_the_end(change_.xml(file), "parameter")) {
    const std::optional<std::string> name = change_.xml(file).attribute(parameter, "joint");
    const auto old = std::ranges::find(state.chain.joints, name, &ChainText::Joint::name);
    if (old == state.chain.joints.end()) {
      continue;
    }
    std::vector<std::string> receivers;
    for (std::size_t i = 0; i < source.size(); ++i) {
      if (source[i] == static_cast<std::size_t>(old - state.chain.joints.begin())) {
        receivers.push_back(state.chain.joints[i].name);
      }
    }
    if (receivers.empty()) {
      change_.apply(file, change_.xml(file).remove(parameter));
      continue;
    }
    const std::string lines = unindented(change_.xml(file), parameter);
    for (std::size_t i = receivers.size(); i-- > 1;) {
      change_.apply(file, change_.xml(file).add_behind(parameter, lines));
      const ElementNumber copy = next_sibling(change_.xml(file), parameter);
      change_.apply(file, change_.xml(file).set_attribute(copy, "joint", receivers[i]));
    }
    change_.apply(file, change_.xml(file).set_attribute(parameter, "joint", receivers.front()));
  }
}

void ChainChange::duplicate_link(const State& state, std::size_t link) {
  const ChainText& chain = state.chain;
  std::vector<std::string> links = names_of(chain.links);
  std::vector<std::string> joints = names_of(chain.joints);
  const ChainText::Link& original = chain.links[link];
  const bool is_body = change_.xml(state.file()).is(original.place, "Body");
  const std::string new_link = free_name(links, counted_names(without_ends(links))
                                                    .value_or(is_body ? CountedNames{without_number(original.name), ""}
                                                                      : CountedNames{"", original.elements.body_name}));
  const std::string new_joint =
      free_name(joints, counted_names(joints).value_or(CountedNames{without_number(chain.joints[link - 1].name), ""}));

  const Eigen::Vector3d length = length_of_link(state.scenario, link);
  shift_links_in_front(change_, state.scenario, chain, link, length);
  replace_link_names(change_, state.file(), find_robot_elements(change_, state.scenario).joints.at(joints[link]).joint,
                     {{original.name, new_link}});
  copy_joint(state, link - 1, new_joint, new_link);
  copy_link(state, link, new_link, length);
  const std::size_t at = chain.joints[link - 1].file_index;
  edit_masks(state, [at](std::string& mask) { mask.insert(at, 1, mask[at]); });
  copy_values(state, chain.joints[link - 1].name, new_joint);
  add_module(state, new_joint);
  links.insert(links.begin() + static_cast<std::ptrdiff_t>(link) + 1, new_link);
  joints.insert(joints.begin() + static_cast<std::ptrdiff_t>(link), new_joint);
  count_names(state, links, joints);
}

void ChainChange::copy_joint(const State& state, std::size_t joint, const std::string& name, const std::string& link) {
  const std::string& file = state.file();
  const ElementNumber original =
      find_robot_elements(change_, state.scenario).joints.at(state.chain.joints[joint].name).joint;
  const std::string lines = unindented(change_.xml(file), original);
  change_.apply(file, change_.xml(file).add_behind(original, lines));
  const ElementNumber copy = next_sibling(change_.xml(file), original);
  const std::string& rear = state.chain.links[joint].name;
  const std::string& front = state.chain.links[joint + 1].name;
  replace_link_names(change_, file, copy, {{rear, front}, {front, link}});
  change_.apply(file, change_.xml(file).set_attribute(copy, "name", name));
}

void ChainChange::copy_link(const State& state, std::size_t link, const std::string& name,
                            const Eigen::Vector3d& shift) {
  const std::string& file = state.file();
  const ChainText::Link& original = state.chain.links[link];
  const ElementNumber place = find_robot_elements(change_, state.scenario).links.at(original.name).place.value();
  const std::string lines = unindented(change_.xml(file), place);
  change_.apply(file, change_.xml(file).add_behind(place, lines));
  const ElementNumber copy = next_sibling(change_.xml(file), place);
  change_.apply(file, link_name_patch(change_.xml(file), copy, original.elements, name));
  Pose pose = pose_of(change_.xml(file), copy);
  pose.position += in_frame_around(change_.xml(file), copy, shift);
  set_pose(change_, file, copy, pose);
}

void ChainChange::remove_link(State state, std::size_t link) {
  // A joint in the frame of the link in front of it stays with that link; the joint behind goes with this one.
  const bool goes_with_rear = !state.chain.joints[link].is_framed_by_rear;
  if (!goes_with_rear) {
    std::vector<std::size_t> source = present_order(state.joint_count());
    std::swap(source[link - 1], source[link]);
    assign(state, source);
    state = read();
  }
  const ChainText& chain = state.chain;
  const std::size_t removed = goes_with_rear ? link - 1 : link;
  const std::size_t kept = goes_with_rear ? link : link - 1;
  const std::string& neighbour = chain.links[goes_with_rear ? link - 1 : link + 1].name;
  std::vector<std::string> links = names_of(chain.links);
  std::vector<std::string> joints = names_of(chain.joints);
  shift_links_in_front(change_, state.scenario, chain, link, -length_of_link(state.scenario, link));
  replace_link_names(change_, state.file(),
                     find_robot_elements(change_, state.scenario).joints.at(chain.joints[kept].name).joint,
                     {{chain.links[link].name, neighbour}});
  change_.apply(
      state.file(),
      change_.xml(state.file()).remove(find_robot_elements(change_, state.scenario).joints.at(joints[removed]).joint));
  change_.apply(state.file(),
                change_.xml(state.file())
                    .remove(find_robot_elements(change_, state.scenario).links.at(links[link]).place.value()));
  remove_mentions(state, joints[removed], links[link]);
  const std::size_t at = chain.joints[removed].file_index;
  edit_masks(state, [at](std::string& mask) { mask.erase(at, 1); });
  links.erase(links.begin() + static_cast<std::ptrdiff_t>(link));
  joints.erase(joints.begin() + static_cast<std::ptrdiff_t>(removed));
  count_names(state, links, joints);
}

void ChainChange::remove_mentions(const State& state, const std::string& joint, const std::string& link) {
  for (const std::string& file : {state.file(), state.scenario.actuation_file}) {
    for (ElementNumber i = change_.xml(file).size(); i-- > 1;) {
      const XmlText& xml = change_.xml(file);
      const bool names_joint = (xml.is(i, "module") || xml.is(i, "parameter")) && xml.attribute(i, "joint") == joint;
      bool is_sensor_of_it = false;
      if (xml.is(i, "AttachedSensor")) {
        const auto link_tag = xml.child(i, "link");
        const auto joint_tag = xml.child(i, "joint");
        is_sensor_of_it =
            (link_tag && content_of(xml, *link_tag) == link) || (joint_tag && content_of(xml, *joint_tag) == joint);
      }
      bool is_pair_with_it = false;
      if (xml.is(i, "adjacent")) {
        const std::string content = content_of(xml, i);
        const std::vector<std::string_view> bodies = words(content);
        is_pair_with_it = std::ranges::find(bodies, link) != bodies.end();
      }
      if (names_joint || is_sensor_of_it || is_pair_with_it) {
        change_.apply(file, xml.remove(i));
      }
    }
  }
}

void ChainChange::edit_masks(const State& state, const MaskEdit& edit) {
  const std::string& file = state.scenario.actuation_file;
  for (const ElementNumber element : from_the_end(change_.xml(file), "jointConfiguration")) {
    std::string mask = change_.xml(file).attribute(element, "joints").value_or("");
    if (mask.size() == state.joint_count()) {
      edit(mask);
      change_.apply(file, change_.xml(file).set_attribute(element, "joints", mask));
    }
  }
}

void ChainChange::copy_values(const State& state, const std::string& joint, const std::string& copy) {
  const std::string& file = state.scenario.actuation_file;
  for (const ElementNumber parameter : from_the_end(change_.xml(file), "parameter")) {
    if (change_.xml(file).attribute(parameter, "joint") != joint) {
      continue;
    }
    const std::string lines = unindented(change_.xml(file), parameter);
    change_.apply(file, change_.xml(file).add_behind(parameter, lines));
    const ElementNumber added = next_sibling(change_.xml(file), parameter);
    change_.apply(file, change_.xml(file).set_attribute(added, "joint", copy));
  }
}

/// A robot has a <module> for each joint, or none.
void ChainChange::add_module(const State& state, const std::string& joint) {
  const XmlText& xml = change_.xml(state.file());
  const std::vector<ElementNumber> modules = xml.children(0, "module");
  if (modules.empty()) {
    return;
  }
  std::set<unsigned> taken;
  for (const ModulePlace& place : state.scenario.modules) {
    taken.insert(place.node);
  }
  unsigned node = 1;
  while (taken.contains(node)) {
    ++node;
  }
  change_.apply(state.file(), xml.add_behind(modules.back(), "<module joint=\"" + escaped_xml(joint) + "\" node=\"" +
                                                                 std::to_string(node) + "\"/>"));
}

void ChainChange::count_names(const State& before, const std::vector<std::string>& links,
                              const std::vector<std::string>& joints) {
  const auto new_names = [](const std::optional<CountedNames>& pattern, const std::vector<std::string>& names) {
    NewNames renamed;
    for (std::size_t i = 0; pattern && i < names.size(); ++i) {
      if (std::string name = pattern->at(i, names.size()); name != names[i]) {
        renamed.emplace(names[i], std::move(name));
      }
    }
    return renamed;
  };
  const NewNames new_joints = new_names(counted_names(names_of(before.chain.joints)), joints);
  if (!new_joints.empty()) {
    replace_joint_names(change_, before.scenario, new_joints, true);
  }
  const NewNames new_links = new_names(counted_names(without_ends(names_of(before.chain.links))), without_ends(links));
  if (new_links.empty()) {
    return;
  }
  const RobotElements elements = find_robot_elements(change_, before.scenario);
  std::vector<TextPatch> patches;
  for (const auto& [old_name, name] : new_links) {
    const LinkElements& link = elements.links.at(old_name);
    patches.push_back(link_name_patch(change_.xml(before.file()), link.place.value(), link, name));
  }
  change_.apply_all(before.file(), std::move(patches));
  replace_link_names(change_, before.file(), new_links);
}

}  // namespace proleg::sim
