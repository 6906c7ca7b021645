#include "sim/urdf/urdf_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"
#include "sim/urdf/urdf_values.hpp"

namespace proleg::sim {
namespace {

/// Kinds of things that are lost, each with the lines where they are.
class LostThings {
 public:
  void add(const std::string& what, int line) {
    auto known = std::ranges::find(things_, what, &Thing::what);
    if (known == things_.end()) {
      if (things_.size() == most_kinds) {
        return;
      }
      known = things_.insert(things_.end(), {what, {}});
    }
    known->lines.push_back(line);
  }

  [[nodiscard]] std::vector<std::string> lines() const {
    constexpr std::size_t most = 5;
    std::vector<std::string> result;
    for (const Thing& thing : things_) {
      std::string text = thing.what + (thing.lines.size() == 1 ? " (line " : " (lines ");
      for (std::size_t i = 0; i < std::min(most, thing.lines.size()); ++i) {
        text += (i > 0 ? ", " : "") + std::to_string(thing.lines[i]);
      }
      result.push_back(text + (thing.lines.size() > most ? ", ...)" : ")"));
    }
    return result;
  }

 private:
  static constexpr std::size_t most_kinds = 100;

  struct Thing {
    std::string what;
    std::vector<int> lines;
  };
  std::vector<Thing> things_;
};

class UrdfCheck {
 public:
  explicit UrdfCheck(const XmlDocument& document) : root_(document.root("robot")) {}

  UrdfElements run() {
    for (const XmlElement& child : root_.children()) {
      if (lower_case(child.label()).starts_with("<xacro:") || child.is("link") || child.is("joint") ||
          child.is("material")) {
        check_urdf_values(child);
      }
      read_top(child);
    }
    if (elements_.links.empty()) {
      root_.refuse("no <link> in " + root_.label(), "links and joints");
    }
    for (const XmlElement& joint : elements_.joints) {
      check_joint(joint);
    }
    check_tree();
    for (const auto& [link, line] : gazebo_links_) {
      if (!line_of_link_.contains(link)) {
        lost_.add("<gazebo> of the unknown link or joint " + in_quotes(link), line);
      }
    }
    elements_.lost = lost_.lines();
    return std::move(elements_);
  }

 private:
  void read_top(const XmlElement& element) {
    if (element.is("link")) {
      note_name(element, line_of_link_, "link");
      check_link(element);
      elements_.links.push_back(element);
    } else if (element.is("joint")) {
      note_name(element, line_of_joint_, "joint");
      elements_.joints.push_back(element);
    } else if (element.is("gazebo")) {
      read_gazebo(element);
    } else if (!element.is("material")) {
      lost_.add(element.label(), element.line());
    }
  }

  void note_name(const XmlElement& element, std::map<std::string, int>& lines, const std::string& kind) {
    const std::string name = checked_name(element, element.required_attribute("name"));
    const auto [known, is_new] = lines.emplace(name, element.line());
    if (!is_new) {
      element.refuse("a second " + kind + " " + in_quotes(name),
                     "another name; the first is in line " + std::to_string(known->second));
    }
  }

  void check_link(const XmlElement& link) {
    for (const XmlElement& child : link.children()) {
      if (child.is("visual") || child.is("collision")) {
        check_shape(child);
      } else if (child.is("inertial")) {
        check_inertial(child, link);
      } else {
        lost_.add(child.label() + " of a link", child.line());
      }
    }
    static_cast<void>(link.child("inertial"));  // at most one
  }

  void check_shape(const XmlElement& shape) {
    const XmlElement geometry = shape.required_child("geometry");
    std::vector<XmlElement> solids = geometry.children();
    constexpr std::array<std::string_view, 4> kinds{"box", "sphere", "cylinder", "mesh"};
    const auto is_known = [&](const XmlElement& solid) {
      return std::ranges::any_of(kinds, [&](std::string_view kind) { return solid.is(kind); });
    };
    if (solids.size() != 1 || !is_known(solids.front())) {
      geometry.refuse((solids.empty() ? "nothing" : solids.front().label()) + " in " + geometry.label(),
                      "one <box>, <sphere>, <cylinder> or <mesh>");
    }
    const XmlElement& solid = solids.front();
    require_urdf_sizes(solid);
    if (solid.is("mesh") && solid.required_attribute("filename").empty()) {
      solid.refuse("an empty filename in " + solid.label(), "that of a mesh");
    }
    if (const auto material = shape.child("material"); material && material->child("texture")) {
      lost_.add("<texture> of a <visual>", material->line());
    }
  }

  void check_inertial(const XmlElement& inertial, const XmlElement& link) {
    const XmlElement mass = inertial.required_child("mass");
    const std::string text = mass.required_attribute("value");
    if (const std::optional<double> value = parse_number(text); value && *value < 0.0) {
      mass.refuse("a mass of " + text + " kg in link " + in_quotes(link.required_attribute("name")),
                  "a mass above 0, or 0 for a frame without mass");
    }
    const XmlElement inertia = inertial.required_child("inertia");
    for (const std::string_view moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
      static_cast<void>(inertia.required_attribute(moment));
    }
  }

  void check_joint(const XmlElement& joint) {
    const std::string name = joint.required_attribute("name");
    const std::string type = joint.required_attribute("type");
    if (type != "revolute" && type != "continuous" && type != "fixed") {
      joint.refuse("joint " + in_quotes(name) + " of type " + in_quotes(type),
                   "'revolute', 'continuous' or 'fixed': a joint of Proleg is a hinge with a servo");
    }
    if (const auto mimic = joint.child("mimic")) {
      mimic->refuse("joint " + in_quotes(name) + " that follows another joint, " + mimic->label(),
                    "joints with a servo of their own; make it 'fixed'");
    }
    for (const std::string_view end : {"parent", "child"}) {
      const XmlElement element = joint.required_child(end);
      if (const std::string link = element.required_attribute("link"); !line_of_link_.contains(link)) {
        element.refuse("the unknown link " + in_quotes(link) + " in joint " + in_quotes(name),
                       "one of " + known_links());
      }
    }
    if (type != "fixed") {
      check_motion(joint, name, type);
    }
    for (const XmlElement& child : joint.children()) {
      constexpr std::array<std::string_view, 6> read{"origin", "parent", "child", "axis", "limit", "mimic"};
      const bool is_read =
          std::ranges::any_of(read, [&](std::string_view tag) { return child.is(tag); }) || has_no_effect(child);
      if (!is_read) {
        lost_.add(child.label() + " of a joint", child.line());
      }
    }
  }

  /// <dynamics> without damping and friction.
  static bool has_no_effect(const XmlElement& element) {
    const auto is_zero = [&](std::string_view attribute) {
      const std::optional<std::string> text = element.attribute(attribute);
      return !text || parse_number(*text) == 0.0;
    };
    return element.is("dynamics") && is_zero("damping") && is_zero("friction");
  }

  static void check_motion(const XmlElement& joint, const std::string& name, const std::string& type) {
    if (const auto axis = joint.child("axis")) {
      double square = 0.0;
      const std::string text = axis->required_attribute("xyz");
      for (const std::string_view word : words(text)) {
        const double part = parse_number(word).value_or(0.0);
        square += part * part;
      }
      constexpr double least = 1e-6;
      if (std::sqrt(square) < least) {
        axis->refuse("the axis " + in_quotes(text) + " of joint " + in_quotes(name), "a direction that is not 0");
      }
    }
    if (type != "revolute") {
      return;
    }
    const XmlElement limit = joint.required_child("limit");
    const auto value = [&](std::string_view attribute) {
      const std::optional<std::string> text = limit.attribute(attribute);
      return text ? parse_number(*text).value_or(0.0) : 0.0;
    };
    if (value("lower") >= value("upper")) {
      limit.refuse("limits " + number_text(value("lower")) + " to " + number_text(value("upper")) + " rad of joint " +
                       in_quotes(name),
                   "a lower limit below the upper one; a joint that does not move is 'fixed'");
    }
    static_cast<void>(limit.required_attribute("effort"));
    static_cast<void>(limit.required_attribute("velocity"));
  }

  void check_tree() {
    std::map<std::string, std::pair<std::string, XmlElement>> joint_above;  // by child: its parent, and the joint
    for (const XmlElement& joint : elements_.joints) {
      const std::string parent = joint.required_child("parent").required_attribute("link");
      const std::string child = joint.required_child("child").required_attribute("link");
      const auto [known, is_new] = joint_above.emplace(child, std::pair(parent, joint));
      if (!is_new) {
        joint.refuse("link " + in_quotes(child) + " as the child of a second joint",
                     "one; the first is in line " + std::to_string(known->second.second.line()));
      }
    }
    const XmlElement* root = nullptr;
    for (const XmlElement& link : elements_.links) {
      const std::string name = link.required_attribute("name");
      if (!joint_above.contains(name)) {
        if (root != nullptr) {
          link.refuse(
              "link " + in_quotes(name) + " that no joint connects to " + in_quotes(root->required_attribute("name")),
              "one tree: one link that is no child of a joint");
        }
        root = &link;
      }
    }
    check_reached(root);
  }

  /// All links are below the root. Those that are not are in a ring, or below one.
  void check_reached(const XmlElement* root) {
    std::multimap<std::string, std::string> children;
    for (const XmlElement& joint : elements_.joints) {
      children.emplace(joint.required_child("parent").required_attribute("link"),
                       joint.required_child("child").required_attribute("link"));
    }
    std::set<std::string> reached;
    std::vector<std::string> next;
    if (root != nullptr) {
      next.push_back(root->required_attribute("name"));
    }
    while (!next.empty()) {
      const std::string link = next.back();
      next.pop_back();
      reached.insert(link);
      const auto [first, last] = children.equal_range(link);
      std::transform(first, last, std::back_inserter(next), [](const auto& pair) { return pair.second; });
    }
    for (const XmlElement& link : elements_.links) {
      if (const std::string name = link.required_attribute("name"); !reached.contains(name)) {
        link.refuse("link " + in_quotes(name) + " in a ring of links, or below one", "a tree");
      }
    }
  }

  /// Of a <gazebo> the friction of a link is read, because no other tag of URDF has it.
  void read_gazebo(const XmlElement& element) {
    const std::optional<std::string> reference = element.attribute("reference");
    const auto mu = element.child("mu1");
    for (const XmlElement& child : element.children()) {
      if (!(reference && (child.is("mu1") || child.is("mu2")))) {
        lost_.add(child.label() + " in <gazebo>", child.line());
      }
    }
    if (!reference || !mu) {
      return;
    }
    const auto read = [](const XmlElement& coefficient) {
      const auto value = coefficient.attribute("value");
      return parse_number_in(value ? *value : coefficient.text({"value"}), frictions);
    };
    const std::optional<double> along = read(*mu);
    if (!along) {
      lost_.add("<mu1> that is no number from 0 to 1000 in <gazebo>", mu->line());
      return;
    }
    gazebo_links_.emplace_back(*reference, element.line());
    elements_.friction[*reference] = *along;
    if (const auto across = element.child("mu2"); across && read(*across) != along) {
      lost_.add("<mu2> that differs from <mu1> in <gazebo>", across->line());
    }
  }

  [[nodiscard]] std::string known_links() const {
    std::vector<std::string> names;
    for (const auto& [name, line] : line_of_link_) {
      names.push_back(name);
    }
    return listed(names);
  }

  XmlElement root_;
  UrdfElements elements_;
  std::map<std::string, int> line_of_link_;
  std::map<std::string, int> line_of_joint_;
  std::vector<std::pair<std::string, int>> gazebo_links_;  ///< link and line of each <gazebo> with a friction
  LostThings lost_;
};

}  // namespace

UrdfElements check_urdf(const XmlDocument& document) { return UrdfCheck(document).run(); }

}  // namespace proleg::sim
