#include "sim/scenario/joint_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range torques{1e-9, 1e6, "Nm"};
constexpr Range speeds{1e-9, 1e6, "rad/s"};
constexpr Range limits_in_degrees{-360.0, 360.0, "degrees"};
constexpr Range limits_in_radians{-6.2832, 6.2832, "rad"};
constexpr double min_axis = 1e-6;

/// Raw value of a limit in degrees, from its text, so that floating point adds no rounding.
std::int32_t kernel_limit(std::string_view degrees) {
  const DecimalResult result = parse_decimal(degrees, Unit::degree);
  if (result.error == DecimalError::none) {
    return std::clamp(result.raw, -quarter_turn, quarter_turn);
  }
  return degrees.starts_with('-') ? -quarter_turn : quarter_turn;
}

std::int32_t kernel_limit(double radians) {
  const double raw = std::round(radians * (2.0 / std::numbers::pi) * quarter_turn);
  return static_cast<std::int32_t>(
      std::clamp(raw, -static_cast<double>(quarter_turn), static_cast<double>(quarter_turn)));
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
    kernel = {kernel_limit(words(text)[0]), kernel_limit(words(text)[1])};
  } else {
    joint.lower_limit = numbers[0];
    joint.upper_limit = numbers[1];
    kernel = {kernel_limit(numbers[0]), kernel_limit(numbers[1])};
  }
}

}  // namespace

JointDescription read_joint(const XmlElement& element, std::vector<std::string>& remarks) {
  element.allow({"name", "type", "enable", "circular"}, {"body", "offsetfrom", "anchor", "axis", "limitsdeg", "limits",
                                                         "maxtorque", "maxvel", "maxaccel", "resolution", "weight"});
  JointDescription description;
  Joint& joint = description.joint;
  joint.name = checked_name(element, element.required_attribute("name"));
  if (const std::string type = element.required_attribute("type"); lower_case(type) != "hinge") {
    element.refuse("type " + in_quotes(type) + " in " + element.label(), "'hinge'");
  }

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
  if (const auto acceleration = element.child("maxaccel")) {
    remark_no_effect(remarks, *acceleration, "a servo has limits of torque and speed only");
  }
  return description;
}

}  // namespace proleg::sim
