#include "sim/urdf/urdf_check.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

class UrdfCheck {
 public:
  UrdfCheck(const XmlDocument& document, UrdfRemarks& remarks) : root_(document.root("robot")), remarks_(&remarks) {}

  UrdfElements run() {
    lose_others(root_, {"name", "version"}, {"link", "joint", "gazebo", "material"}, *remarks_);
    if (const auto version = root_.attribute("version"); version && !version->starts_with("1")) {
      remarks_->lost.add("version=" + in_quotes(*version) + " of <robot>, which is read as 1.2", root_.line());
    }
    for (const XmlElement& child : root_.children()) {
      if (lower_case(child.label()).starts_with("<xacro:") || child.is("link") || child.is("joint") ||
          child.is("material")) {
        refuse_xacro(child);
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
        remarks_->lost.add("<gazebo> of the unknown link or joint " + in_quotes(link), line);
      }
    }
    return std::move(elements_);
  }

 private:
  void read_top(const XmlElement& element) {
    if (element.is("link")) {
      note_name(element, line_of_link_, "link");
      note_contents(element);
      elements_.links.push_back(element);
    } else if (element.is("joint")) {
      note_name(element, line_of_joint_, "joint");
      elements_.joints.push_back(element);
    } else if (element.is("gazebo")) {
      read_gazebo(element);
    } else if (element.is("material")) {
      note_material(element);
    }
  }

  void note_contents(const XmlElement& link) {
    for (const XmlElement& child : link.children()) {
      elements_.has_collision = elements_.has_collision || child.is("collision");
      if (child.is("visual")) {
        for (const XmlElement& material : child.children()) {
          note_material(material);
        }
      }
    }
  }

  /// A material that another element may name. The first one of a name counts.
  void note_material(const XmlElement& element) {
    const std::optional<std::string> name = element.attribute("name");
    if (!element.is("material") || !name || elements_.materials.contains(*name)) {
      return;
    }
    UrdfRemarks of_uses;  // where the material is read
    if (const auto colour = urdf_colour(element, of_uses)) {
      elements_.materials.emplace(*name, *colour);
    }
  }

  void note_name(const XmlElement& element, std::map<std::string, int>& lines, const std::string& kind) {
    const std::string name = urdf_name(element, "name");
    const auto [known, is_new] = lines.emplace(name, element.line());
    if (!is_new) {
      element.refuse("a second " + kind + " " + in_quotes(name),
                     "another name; the first is in line " + std::to_string(known->second));
    }
  }

  void check_joint(const XmlElement& joint) {
    const std::string name = urdf_name(joint, "name");
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
      if (const std::string link = urdf_name(element, "link"); !line_of_link_.contains(link)) {
        element.refuse("the unknown link " + in_quotes(link) + " in joint " + in_quotes(name),
                       "one of " + known_links());
      }
    }
  }

  void check_tree() {
    std::map<std::string, std::pair<std::string, XmlElement>> joint_above;  // by child: its parent, and the joint
    for (const XmlElement& joint : elements_.joints) {
      const std::string parent = urdf_name(joint.required_child("parent"), "link");
      const std::string child = urdf_name(joint.required_child("child"), "link");
      const auto [known, is_new] = joint_above.emplace(child, std::pair(parent, joint));
      if (!is_new) {
        joint.refuse("link " + in_quotes(child) + " as the child of a second joint",
                     "one; the first is in line " + std::to_string(known->second.second.line()));
      }
    }
    const XmlElement* root = nullptr;
    for (const XmlElement& link : elements_.links) {
      const std::string name = urdf_name(link, "name");
      if (!joint_above.contains(name)) {
        if (root != nullptr) {
          link.refuse("link " + in_quotes(name) + " that no joint connects to " + in_quotes(urdf_name(*root, "name")),
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
      children.emplace(urdf_name(joint.required_child("parent"), "link"),
                       urdf_name(joint.required_child("child"), "link"));
    }
    std::set<std::string> reached;
    std::vector<std::string> next;
    if (root != nullptr) {
      next.push_back(urdf_name(*root, "name"));
    }
    while (!next.empty()) {
      const std::string link = next.back();
      next.pop_back();
      reached.insert(link);
      const auto [first, last] = children.equal_range(link);
      std::transform(first, last, std::back_inserter(next), [](const auto& pair) { return pair.second; });
    }
    for (const XmlElement& link : elements_.links) {
      if (const std::string name = urdf_name(link, "name"); !reached.contains(name)) {
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
        remarks_->lost.add(child.label() + " in <gazebo>", child.line());
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
      remarks_->lost.add("<mu1> that is no number from 0 to 1000 in <gazebo>", mu->line());
      return;
    }
    gazebo_links_.emplace_back(*reference, element.line());
    elements_.friction[*reference] = *along;
    if (const auto across = element.child("mu2"); across && read(*across) != along) {
      remarks_->lost.add("<mu2> that differs from <mu1> in <gazebo>", across->line());
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
  UrdfRemarks* remarks_;
};

}  // namespace

UrdfElements check_urdf(const XmlDocument& document, UrdfRemarks& remarks) {
  return UrdfCheck(document, remarks).run();
}

std::optional<Eigen::Vector3d> urdf_colour(const XmlElement& material, UrdfRemarks& remarks) {
  for (const XmlElement& child : material.children()) {
    if (!child.is("color")) {
      continue;
    }
    const std::string text = child.attribute("rgba").value_or("");
    std::vector<double> parts;
    for (const std::string_view word : words(text)) {
      constexpr Range shares{0.0, 1.0, ""};
      parts.push_back(parse_number_in(word, shares).value_or(-1.0));
    }
    const bool is_good = (parts.size() == 3 || parts.size() == 4) && *std::ranges::min_element(parts) >= 0.0;
    if (is_good) {
      return Eigen::Vector3d(parts[0], parts[1], parts[2]);
    }
    remarks.lost.add("the colour " + in_quotes(text) + ": expected 4 numbers from 0 to 1", child.line());
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace proleg::sim
