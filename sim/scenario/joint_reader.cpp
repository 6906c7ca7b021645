#include "sim/scenario/joint_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range torques{1e-9, 1e6, "Nm"};
constexpr Range speeds{1e-9, 1e6, "rad/s"};
constexpr Range limits_in_degrees{-360.0, 360.0, "degrees"};
constexpr Range limits_in_radians{-6.2832, 6.2832, "rad"};
constexpr Range planner_values{0.0, 1e9, ""};
constexpr Range speeds_in_degrees{1e-7, 1e8, "degrees/s"};
constexpr double radians_per_degree = std::numbers::pi / 180.0;
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

/// Reads <limitsdeg>, or <limits> or <limitsrad>, or OpenRAVE's older <lostop> and <histop>: degrees about the axis in
/// the opposite direction, which it becomes.
void read_limits(const XmlElement& element, JointDescription& description) {
  std::vector<XmlElement> given;
  for (const std::string_view tag : {"limitsdeg", "limits", "limitsrad", "lostop"}) {
    if (const auto child = element.child(tag)) {
      given.push_back(*child);
    }
  }
  if (given.size() != 1) {
    element.refuse((given.empty() ? std::string("neither <limitsdeg> nor <limits>")
                                  : "both " + given[0].label() + " and " + given[1].label()) +
                       " in " + element.label(),
                   "one of them");
  }
  const XmlElement& limits = given.front();
  const bool is_old = limits.is("lostop");
  const bool is_degrees = is_old || limits.is("limitsdeg");
  const Range& range = is_degrees ? limits_in_degrees : limits_in_radians;
  std::string text = limits.text();
  std::vector<double> numbers;
  if (is_old) {
    const XmlElement upper = element.required_child("histop");
    numbers = {read_number(limits, range), read_number(upper, range)};
    text += " " + upper.text();
    description.joint.axis = -description.joint.axis;
  } else if (const auto upper = element.child("histop")) {
    upper->refuse("both " + limits.label() + " and <histop> in " + element.label(), "one of them");
  } else {
    numbers = read_numbers(limits, 2, range);
  }
  if (numbers[0] > numbers[1]) {
    limits.refuse(in_quotes(text) + " in " + limits.label(), "the lower limit first");
  }
  if (numbers[0] > 0.0 || numbers[1] < 0.0) {
    limits.refuse(in_quotes(text) + " in " + limits.label() + " of joint " + in_quotes(description.joint.name),
                  "limits that include 0, because every joint starts at angle 0");
  }
  Joint& joint = description.joint;
  AngleLimits& kernel = description.kernel_limits;
  if (is_degrees) {
    joint.lower_limit = numbers[0] * radians_per_degree;
    joint.upper_limit = numbers[1] * radians_per_degree;
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
                                    std::pair("hardmaxvel", "<maxvel> is the limit of the servo"),
                                    std::pair("resolution", "no planner divides the angle into steps"),
                                    std::pair("weight", "no planner weighs the joints")}) {
    if (const auto child = element.child(tag)) {
      static_cast<void>(read_number(*child, planner_values));
      remark_no_effect(remarks, *child, reason);
    }
  }
}

/// Reads <maxvel> (rad/s) or <maxveldeg> (degrees/s).
double read_max_speed(const XmlElement& element) {
  const std::optional<XmlElement> degrees = element.child("maxveldeg");
  if (degrees && element.child("maxvel")) {
    element.refuse("both <maxvel> and <maxveldeg> in " + element.label(), "one of them");
  }
  return degrees ? read_number(*degrees, speeds_in_degrees) * radians_per_degree
                 : read_number(element.required_child("maxvel"), speeds);
}

}  // namespace

JointDescription read_joint(const XmlElement& element, std::vector<std::string>& remarks) {
  element.allow({"name", "type", "enable", "circular"},
                {"body", "offsetfrom", "anchor", "axis", "limitsdeg", "limits", "limitsrad", "lostop", "histop",
                 "maxtorque", "maxvel", "maxveldeg", "hardmaxvel", "maxaccel", "resolution", "weight"});
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
  joint.max_speed = read_max_speed(element);

  constexpr double right_angle = std::numbers::pi / 2.0;
  if (joint.lower_limit < -right_angle * (1.0 + 1e-12) || joint.upper_limit > right_angle * (1.0 + 1e-12)) {
    remarks.push_back(one_line(element.document().name() + ":" + std::to_string(element.line()) + ": joint " +
                               in_quotes(joint.name) +
                               " has limits beyond +-90 degrees; it moves within +-90 degrees"));
  }
  check_planner_tags(element, remarks);
  return description;
}

}  // namespace proleg::sim
