#include "sim/scenario/kinbody_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

/// The contents of a <Joint>, with names as in the file.
struct JointDescription {
  Joint joint;  ///< anchor and axis in the frame of `offset_from`
  std::array<std::string, 2> bodies;
  std::optional<std::string> offset_from;
  AngleLimits kernel_limits;
};

constexpr Range torques{1e-9, 1e6, "Nm"};
constexpr Range speeds{1e-9, 1e6, "rad/s"};
constexpr Range limits_in_degrees{-360.0, 360.0, "degrees"};
constexpr Range limits_in_radians{-6.2832, 6.2832, "rad"};
constexpr Range planner_values{0.0, 1e9, ""};
constexpr double min_axis = 1e-6;

std::int32_t kernel_limit(double radians) {
  const double raw = std::round(radians * (2.0 / std::numbers::pi) * quarter_turn);
  return static_cast<std::int32_t>(
      std::clamp(raw, -static_cast<double>(quarter_turn), static_cast<double>(quarter_turn)));
}

/// Raw value of a limit in degrees, from its text, so that floating point adds no rounding. A text with too many digits
/// has that rounding.
std::int32_t kernel_limit(std::string_view degrees, double radians) {
  const DecimalResult result = parse_decimal(degrees, Unit::degree);
  return result.error == DecimalError::none ? std::clamp(result.raw, -quarter_turn, quarter_turn)
                                            : kernel_limit(radians);
}

void read_limits(const XmlElement& element, JointDescription& description) {
  const std::optional<XmlElement> degrees = element.child("limitsdeg");
  const std::optional<XmlElement> radians = element.child("limits");
  if (degrees.has_value() == radians.has_value()) {
    element.refuse(
        (degrees ? "both <limitsdeg> and <limits> in " : "neither <limitsdeg> nor <limits> in ") + element.label(),
        "one of them");
  }
  const XmlElement& limits = degrees ? *degrees : *radians;
  const std::vector<double> numbers = read_numbers(limits, 2, degrees ? limits_in_degrees : limits_in_radians);
  if (numbers[0] > numbers[1]) {
    limits.refuse(in_quotes(limits.text()) + " in " + limits.label(), "the lower limit first");
  }
  if (numbers[0] > 0.0 || numbers[1] < 0.0) {
    limits.refuse(in_quotes(limits.text()) + " in " + limits.label() + " of joint " + in_quotes(description.joint.name),
                  "limits that include 0, because every joint starts at angle 0");
  }
  Joint& joint = description.joint;
  AngleLimits& kernel = description.kernel_limits;
  if (degrees) {
    constexpr double radians_per_degree = std::numbers::pi / 180.0;
    joint.lower_limit = numbers[0] * radians_per_degree;
    joint.upper_limit = numbers[1] * radians_per_degree;
    const std::string text = limits.text();
    kernel = {kernel_limit(words(text)[0], joint.lower_limit), kernel_limit(words(text)[1], joint.upper_limit)};
  } else {
    joint.lower_limit = numbers[0];
    joint.upper_limit = numbers[1];
    kernel = {kernel_limit(numbers[0]), kernel_limit(numbers[1])};
  }
}

/// Refuses the kinds of joints of OpenRAVE that Proleg does not have.
void check_switches(const XmlElement& element) {
  if (element.attribute("enable") && !read_switch_attribute(element, "enable")) {
    element.refuse("a passive joint, enable='false' in " + element.label(),
                   "joints that a servo moves, without this attribute or with enable='true'; to fix two bodies to each "
                   "other, write one <Body> with the geometries of both");
  }
  if (element.attribute("circular") && read_switch_attribute(element, "circular")) {
    element.refuse("a joint that turns without end, circular='true' in " + element.label(),
                   "joints with limits, without this attribute or with circular='false'");
  }
}

/// Properties of a joint that only OpenRAVE's planners use. They have no effect.
void check_planner_tags(const XmlElement& element, std::vector<std::string>& remarks) {
  for (const auto& [tag, reason] : {std::pair("maxaccel", "a servo has limits of torque and speed only"),
                                    std::pair("resolution", "no planner divides the angle into steps"),
                                    std::pair("weight", "no planner weighs the joints")}) {
    if (const auto child = element.child(tag)) {
      static_cast<void>(read_number(*child, planner_values));
      remark_no_effect(remarks, *child, reason);
    }
  }
}

/// Reads a <Joint type="hinge">: two <body>, <axis>, <anchor> (0 0 0 by default), <offsetfrom>, <limitsdeg> or <limits>
/// (radians), <maxtorque> (Nm), <maxvel> (rad/s). The model keeps limits beyond +-90 degrees; the kernel gets +-90
/// degrees, and a remark says so.
JointDescription read_joint(const XmlElement& element, std::vector<std::string>& remarks) {
  element.allow({"name", "type", "enable", "circular"}, {"body", "offsetfrom", "anchor", "axis", "limitsdeg", "limits",
                                                         "maxtorque", "maxvel", "maxaccel", "resolution", "weight"});
  JointDescription description;
  Joint& joint = description.joint;
  joint.name = checked_name(element, element.required_attribute("name"));
  if (const std::string type = element.required_attribute("type"); lower_case(type) != "hinge") {
    element.refuse("type " + in_quotes(type) + " in " + element.label(), "'hinge'");
  }

  check_switches(element);

  std::size_t bodies = 0;
  for (const XmlElement& child : element.children()) {
    if (!child.is("body")) {
      continue;
    }
    if (bodies < description.bodies.size()) {
      description.bodies[bodies] = checked_name(child, child.text());
    }
    ++bodies;
  }
  if (bodies != 2 || description.bodies[0] == description.bodies[1]) {
    element.refuse(bodies != 2
                       ? std::to_string(bodies) + " <body> in joint " + in_quotes(joint.name)
                       : "body " + in_quotes(description.bodies[0]) + " twice in joint " + in_quotes(joint.name),
                   "two bodies");
  }
  if (const auto offset = element.child("offsetfrom")) {
    description.offset_from = checked_name(*offset, offset->text());
  }
  if (const auto anchor = element.child("anchor")) {
    joint.anchor = read_vector(*anchor, coordinates);
  }
  const XmlElement axis = element.required_child("axis");
  joint.axis = read_vector(axis, directions);
  if (joint.axis.norm() < min_axis) {
    axis.refuse(in_quotes(axis.text()) + " in " + axis.label(), "a direction that is not 0");
  }
  read_limits(element, description);
  joint.max_torque = read_number(element.required_child("maxtorque"), torques);
  joint.max_speed = read_number(element.required_child("maxvel"), speeds);

  constexpr double right_angle = std::numbers::pi / 2.0;
  if (joint.lower_limit < -right_angle * (1.0 + 1e-12) || joint.upper_limit > right_angle * (1.0 + 1e-12)) {
    remarks.push_back(one_line(element.document().name() + ":" + std::to_string(element.line()) + ": joint " +
                               in_quotes(joint.name) +
                               " has limits beyond +-90 degrees; it moves within +-90 degrees"));
  }
  check_planner_tags(element, remarks);
  return description;
}

constexpr int max_kinbody_depth = 32;
constexpr std::size_t max_static_bodies = 10'000;

/// Pose and names that the KinBodies around a body give it.
struct Scope {
  Pose pose;
  std::string prefix;
  std::string name;  ///< of the innermost KinBody that has one
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
    constexpr std::array<std::string_view, 3> robot_tags{"Body", "KinBody", "Joint"};
    constexpr std::array<std::string_view, 2> tags_of_environments{"Body", "KinBody"};
    const std::span<const std::string_view> tags =
        use_ == KinBodyUse::robot ? std::span<const std::string_view>(robot_tags) : tags_of_environments;
    constexpr std::array<std::string_view, 1> visual_tags{"visible"};
    element.allow(attributes, joined({tags, pose_tags, extra_tags, visual_tags}));
    if (const auto visible = element.child("visible")) {
      static_cast<void>(read_switch(*visible));
    }
    for (const XmlElement& child : element.children()) {
      if (child.is("KinBody")) {
        read(child, scope, {});
      } else if (child.is("Body")) {
        read_body(child, scope);
      } else if (child.is("Joint")) {
        read_joint_element(child, scope);
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
    return std::move(contents_);
  }

 private:
  static constexpr std::array<std::string_view, 4> attributes{"name", "prefix", "file", "type"};

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
    read_body_mass(element, entry);
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

  void read_body_mass(const XmlElement& element, BodyEntry& entry) {
    if (entry.is_fixed) {
      if (const auto mass = element.child("Mass")) {
        remark_no_effect(*remarks_, *mass, "a static body does not move");
      }
      return;
    }
    entry.link.mass = read_mass(element.required_child("Mass"), entry.link.geometries);
  }

  void read_joint_element(const XmlElement& element, const Scope& scope) {
    if (joints_.size() == max_joints) {
      element.refuse("more than " + std::to_string(max_joints) + " joints", "1 to " + std::to_string(max_joints));
    }
    JointDescription description = read_joint(element, *remarks_);
    PendingJoint pending{{{element.document().name(), element.line()},
                          std::move(description.joint),
                          std::move(description.bodies),
                          description.kernel_limits},
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
