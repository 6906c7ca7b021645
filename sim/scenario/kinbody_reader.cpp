#include "sim/scenario/kinbody_reader.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/joint_reader.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr int max_kinbody_depth = 32;
constexpr std::size_t max_static_bodies = 10'000;

/// Pose and names that the KinBodies around a body give it.
struct Scope {
  Pose pose;
  std::string prefix;
  std::string name;                ///< of the innermost KinBody that has one
  std::optional<XmlElement> mass;  ///< <Mass> of the innermost KinBody, for its bodies without one
  int depth = 0;
};

/// A joint whose frame is still unknown: the body of its <offsetfrom> may be later in the file.
struct PendingJoint {
  JointEntry entry;
  std::optional<std::string> offset_from;
  Pose scope_pose;
};

class KinBodyReader {
 public:
  KinBodyReader(KinBodyUse use, SourceSet& sources, std::vector<std::string>& remarks)
      : use_(use), sources_(&sources), remarks_(&remarks) {}

  void read(const XmlElement& element, Scope scope, std::span<const std::string_view> extra_tags) {
    if (++scope.depth > max_kinbody_depth) {
      element.refuse("KinBodies nested deeper than " + std::to_string(max_kinbody_depth),
                     "at most " + std::to_string(max_kinbody_depth) + " levels");
    }
    if (const auto name = element.attribute("name")) {
      scope.name = checked_name(element, *name);
    }
    if (const auto prefix = element.attribute("prefix"); prefix && !prefix->empty()) {
      scope.prefix += checked_name(element, *prefix);
    }
    scope.pose = scope.pose * read_pose(element);
    if (element.attribute("type")) {
      remark_no_effect_of("type", *remarks_, element, "it chooses a plug-in of OpenRAVE; the type of a <Body> counts");
    }
    if (const auto file = element.attribute("file")) {
      element.allow(attributes, pose_tags);
      const auto document = sources_->open(element, *file);
      read(document->root("KinBody"), scope, {});
      return;
    }
    constexpr std::array<std::string_view, 5> robot_tags{"Body", "KinBody", "Joint", "Mass", "adjacent"};
    constexpr std::array<std::string_view, 3> tags_of_environments{"Body", "KinBody", "Mass"};
    const std::span<const std::string_view> tags =
        use_ == KinBodyUse::robot ? std::span<const std::string_view>(robot_tags) : tags_of_environments;
    constexpr std::array<std::string_view, 1> view_tags{"visible"};
    element.allow(attributes, joined({tags, pose_tags, extra_tags, view_tags}));
    if (const auto visible = element.child("visible")) {
      static_cast<void>(read_switch(*visible));
    }
    scope.mass = element.child("Mass");
    if (scope.mass) {
      check_mass_of_all(*scope.mass);
    }
    for (const XmlElement& child : element.children()) {
      if (child.is("KinBody")) {
        read(child, scope, {});
      } else if (child.is("Body")) {
        read_body(child, scope);
      } else if (child.is("Joint")) {
        read_joint_element(child, scope);
      } else if (child.is("adjacent")) {
        read_adjacent(child, scope);
      }
    }
  }

  KinBodyContents finish() {
    for (PendingJoint& pending : joints_) {
      const Pose frame = pending.offset_from
                             ? find_body(*pending.offset_from, pending.entry.origin, "<offsetfrom>").link.pose
                             : pending.scope_pose;
      Joint& joint = pending.entry.joint;
      joint.anchor = frame * joint.anchor;
      joint.axis = (frame.orientation * joint.axis).normalized();
      for (const std::string& body : pending.entry.bodies) {
        static_cast<void>(find_body(body, pending.entry.origin, "<body>"));
      }
      contents_.joints.push_back(std::move(pending.entry));
    }
    for (const AdjacentBodies& adjacent : contents_.adjacent) {
      for (const std::string& body : adjacent.bodies) {
        static_cast<void>(find_body(body, adjacent.origin, "<adjacent>"));
      }
    }
    return std::move(contents_);
  }

 private:
  static constexpr std::array<std::string_view, 4> attributes{"name", "prefix", "file", "type"};

  /// The <Mass> of a KinBody can only have what depends on each body.
  static void check_mass_of_all(const XmlElement& mass) {
    if (lower_case(mass.required_attribute("type")) != "mimicgeom" || !mass.child("density")) {
      mass.refuse("a " + mass.label() + " of a KinBody that is not type='mimicgeom' with a <density>",
                  "that, or a <Mass> in each <Body>");
    }
  }

  void read_adjacent(const XmlElement& element, const Scope& scope) {
    const std::string text = element.text();
    const std::vector<std::string_view> names = words(text);
    if (names.size() != 2) {
      element.refuse(in_quotes(text) + " in " + element.label(), "the names of two bodies");
    }
    contents_.adjacent.push_back({{element.document().name(), element.line()},
                                  {scope.prefix + std::string(names[0]), scope.prefix + std::string(names[1])}});
  }

  void read_body(const XmlElement& element, const Scope& scope) {
    constexpr std::array<std::string_view, 2> body_attributes{"name", "type"};
    constexpr std::array<std::string_view, 3> tags{"Geom", "Mass", "offsetfrom"};
    element.allow(body_attributes, joined({tags, pose_tags}));
    const bool is_fixed = read_type(element);
    const std::size_t max_bodies = use_ == KinBodyUse::robot ? max_joints + 1 : max_static_bodies;
    if (contents_.bodies.size() == max_bodies) {
      element.refuse("more than " + std::to_string(max_bodies) + " bodies", "at most " + std::to_string(max_bodies));
    }

    BodyEntry entry{{element.document().name(), element.line()}, {}, is_fixed};
    const std::optional<std::string> name = element.attribute("name");
    if (use_ == KinBodyUse::robot) {
      entry.link.name = scope.prefix + checked_name(element, element.required_attribute("name"));
    } else {
      entry.link.name = name ? scope.prefix + checked_name(element, *name) : scope.prefix + scope.name;
    }
    const auto offset = element.child("offsetfrom");
    const Pose frame =
        offset ? find_body(scope.prefix + offset->text(), entry.origin, offset->label()).link.pose : scope.pose;
    entry.link.pose = frame * read_pose(element);
    for (const XmlElement& child : element.children()) {
      if (child.is("Geom")) {
        ReadGeometry read = read_geometry(child, is_fixed ? BodyKind::fixed : BodyKind::moving, *sources_, *remarks_);
        if (read.solid) {
          entry.link.geometries.push_back(std::move(*read.solid));
        }
        if (read.look) {
          entry.link.looks.push_back(std::move(*read.look));
        }
      }
    }
    read_body_mass(element, scope, entry);
    if (use_ == KinBodyUse::robot) {
      const auto same = std::ranges::find(contents_.bodies, entry.link.name, name_of_body);
      if (same != contents_.bodies.end()) {
        element.refuse("a second body " + in_quotes(entry.link.name),
                       "another name; the first is in " + same->origin.file + ":" + std::to_string(same->origin.line));
      }
    }
    contents_.bodies.push_back(std::move(entry));
  }

  /// Whether the body is fixed.
  [[nodiscard]] bool read_type(const XmlElement& element) const {
    const std::optional<std::string> written = element.attribute("type");
    const std::string type = lower_case(written.value_or(use_ == KinBodyUse::robot ? "dynamic" : ""));
    if (use_ == KinBodyUse::robot && type != "dynamic") {
      element.refuse("type " + in_quotes(type) + " in " + element.label(), "'dynamic', because a robot moves");
    }
    if (type != "static" && type != "dynamic") {
      element.refuse((written ? "type " + in_quotes(type) + " in " : "no type in ") + element.label(),
                     "'static' for an object that stays where it is, or 'dynamic' for one that moves");
    }
    return type == "static";
  }

  void read_body_mass(const XmlElement& element, const Scope& scope, BodyEntry& entry) {
    if (entry.is_fixed) {
      if (const auto mass = element.child("Mass")) {
        remark_no_effect(*remarks_, *mass, "a static body does not move");
      }
      return;
    }
    const bool has_own = element.child("Mass").has_value() || !scope.mass;
    entry.link.mass = read_mass(has_own ? element.required_child("Mass") : *scope.mass, entry.link.geometries);
  }

  void read_joint_element(const XmlElement& element, const Scope& scope) {
    if (joints_.size() == max_joints) {
      element.refuse("more than " + std::to_string(max_joints) + " joints", "1 to " + std::to_string(max_joints));
    }
    JointDescription description = read_joint(element, *remarks_);
    PendingJoint pending{{{element.document().name(), element.line()},
                          std::move(description.joint),
                          std::move(description.bodies),
                          description.kernel_limits,
                          false},
                         std::move(description.offset_from),
                         scope.pose};
    JointEntry& entry = pending.entry;
    entry.joint.name = scope.prefix + entry.joint.name;
    entry.joint.file_index = joints_.size();
    for (std::string& body : entry.bodies) {
      body.insert(0, scope.prefix);
    }
    if (pending.offset_from) {
      pending.offset_from = scope.prefix + *pending.offset_from;
      entry.is_in_frame_of_body = std::ranges::find(entry.bodies, *pending.offset_from) != entry.bodies.end();
    }
    const auto same =
        std::ranges::find(joints_, entry.joint.name, [](const PendingJoint& other) { return other.entry.joint.name; });
    if (same != joints_.end()) {
      element.refuse("a second joint " + in_quotes(entry.joint.name),
                     "another name; the first is in line " + std::to_string(same->entry.origin.line));
    }
    joints_.push_back(std::move(pending));
  }

  [[nodiscard]] const BodyEntry& find_body(const std::string& name, const Origin& origin,
                                           const std::string& where) const {
    const auto body = std::ranges::find(contents_.bodies, name, name_of_body);
    if (body == contents_.bodies.end()) {
      std::vector<std::string> known;
      for (const BodyEntry& entry : contents_.bodies) {
        known.push_back(entry.link.name);
      }
      throw InputError(origin.file, origin.line, "unknown body " + in_quotes(name) + " in " + where,
                       "one of " + listed(known));
    }
    return *body;
  }

  static const std::string& name_of_body(const BodyEntry& entry) { return entry.link.name; }

  KinBodyUse use_;
  SourceSet* sources_;
  std::vector<std::string>* remarks_;
  KinBodyContents contents_;
  std::vector<PendingJoint> joints_;
};

}  // namespace

KinBodyContents read_kinbody(const XmlElement& element, KinBodyUse use, SourceSet& sources,
                             std::vector<std::string>& remarks, std::span<const std::string_view> extra_tags) {
  KinBodyReader reader(use, sources, remarks);
  reader.read(element, {}, extra_tags);
  return reader.finish();
}

}  // namespace proleg::sim
