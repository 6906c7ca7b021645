#include "sim/urdf/urdf_values.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t most_kinds = 100;
constexpr std::size_t most_lines = 5;
constexpr Range angles{-1e4, 1e4, "rad"};
constexpr std::string_view xacro_hint = "plain URDF: run 'xacro FILE >ROBOT.urdf' first, and import ROBOT.urdf";

std::string lines_text(const std::vector<int>& lines, std::size_t first) {
  const std::size_t count = lines.size() - first;
  std::string text = count == 1 ? "line " : "lines ";
  for (std::size_t i = 0; i < std::min(most_lines, count); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(lines[first + i]);
  }
  return text + (count > most_lines ? ", ..." : "");
}

bool is_among(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(names, [&](std::string_view known) { return lower_case(name) == known; });
}

/// The rotation Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Quaterniond rotation_of(const std::vector<double>& rpy) {
  return Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
}

Eigen::Quaterniond read_rotation(const XmlElement& origin, UrdfRemarks& remarks) {
  const bool has_angles = origin.attribute("rpy").has_value();
  if (origin.attribute("quat_xyzw")) {
    if (has_angles) {
      origin.refuse("both rpy and quat_xyzw in " + origin.label(), "one of them");
    }
    const std::vector<double> xyzw = urdf_numbers(origin, "quat_xyzw", 4, directions);
    const Eigen::Quaterniond quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    constexpr double least_norm = 1e-6;
    if (quaternion.norm() < least_norm) {
      origin.refuse("quat_xyzw=" + in_quotes(urdf_value(origin, "quat_xyzw")) + " in " + origin.label(),
                    "a quaternion that is not 0");
    }
    return quaternion.normalized();
  }
  if (!has_angles) {
    return Eigen::Quaterniond::Identity();
  }
  const std::vector<double> rpy = urdf_numbers(origin, "rpy", 3, angles);
  constexpr double most = 2.0 * std::numbers::pi * 1.001;  // files round
  const double largest = std::abs(*std::ranges::max_element(rpy, {}, [](double angle) { return std::abs(angle); }));
  if (largest > most) {
    remarks.warnings.add("rpy",
                         "an rpy of " + number_text(largest) + " rad in " + origin.label() +
                             "; usually it is in degrees, and URDF has radians",
                         origin.line());
  }
  return rotation_of(rpy).normalized();
}

}  // namespace

void RemarksByKind::add(const std::string& kind, const std::string& what, int line) {
  auto known = std::ranges::find(remarks_, kind, &Remark::kind);
  if (known == remarks_.end()) {
    if (remarks_.size() == most_kinds) {
      return;
    }
    known = remarks_.insert(remarks_.end(), {kind, what, {}});
  }
  if (known->lines.empty() || known->lines.back() != line) {
    known->lines.push_back(line);
  }
}

std::vector<std::string> RemarksByKind::with_lines() const {
  std::vector<std::string> result;
  for (const Remark& remark : remarks_) {
    result.push_back(remark.what + " (" + lines_text(remark.lines, 0) + ")");
  }
  return result;
}

std::vector<std::string> RemarksByKind::as_warnings(const std::string& file) const {
  std::vector<std::string> result;
  for (const Remark& remark : remarks_) {
    result.push_back(file + ':' + std::to_string(remark.lines.front()) + ": " + remark.what +
                     (remark.lines.size() > 1 ? " (also in " + lines_text(remark.lines, 1) + ")" : ""));
  }
  return result;
}

std::string urdf_value(const XmlElement& element, std::string_view attribute) {
  std::string value = element.required_attribute(attribute);
  std::ranges::replace_if(
      value, [](char letter) { return letter == '\t' || letter == '\n' || letter == '\r'; }, ' ');
  return value;
}

std::string urdf_name(const XmlElement& element, std::string_view attribute) {
  return checked_name(element, urdf_value(element, attribute));
}

std::vector<double> urdf_numbers(const XmlElement& element, std::string_view attribute, std::size_t count,
                                 const Range& range) {
  const std::string text = urdf_value(element, attribute);
  std::vector<double> numbers;
  const std::vector<std::string_view> parts = words(text);
  for (const std::string_view word : parts) {
    if (const std::optional<double> number = parse_number_in(word, range)) {
      numbers.push_back(*number);
    }
  }
  if (numbers.size() != count || parts.size() != count) {
    std::string expected = count == 1 ? "a number" : std::to_string(count) + " numbers";
    if (range.max < any_number.max) {
      expected += " from " + number_text(range.min) + " to " + number_text(range.max);
      expected += range.unit.empty() ? "" : " " + std::string(range.unit);
    }
    element.refuse(std::string(attribute) + "=" + in_quotes(text) + " in " + element.label(), expected);
  }
  return numbers;
}

double urdf_number(const XmlElement& element, std::string_view attribute, const Range& range) {
  return urdf_numbers(element, attribute, 1, range).front();
}

Pose urdf_origin(const XmlElement& parent, UrdfRemarks& remarks) {
  Pose pose;
  const auto origin = parent.child("origin");
  if (!origin) {
    return pose;
  }
  lose_others(*origin, {"xyz", "rpy", "quat_xyzw"}, {}, remarks);
  if (origin->attribute("xyz")) {
    const std::vector<double> xyz = urdf_numbers(*origin, "xyz", 3, coordinates);
    pose.position = {xyz[0], xyz[1], xyz[2]};
  }
  pose.orientation = read_rotation(*origin, remarks);
  return pose;
}

void lose_others(const XmlElement& element, std::initializer_list<std::string_view> attributes,
                 std::initializer_list<std::string_view> tags, UrdfRemarks& remarks) {
  for (const std::string& name : element.attribute_names()) {
    if (!is_among(name, attributes) && !lower_case(name).starts_with("xmlns")) {
      remarks.lost.add("the attribute " + in_quotes(name) + " of " + element.label(), element.line());
    }
  }
  const std::string where = element.is("robot")   ? ""
                            : element.is("link")  ? " of a link"
                            : element.is("joint") ? " of a joint"
                                                  : " in " + element.label();
  for (const XmlElement& child : element.children()) {
    if (std::ranges::none_of(tags, [&](std::string_view tag) { return child.is(tag); })) {
      remarks.lost.add(child.label() + where, child.line());
    }
  }
}

void refuse_xacro(const XmlElement& element) {
  if (lower_case(element.label()).starts_with("<xacro:")) {
    element.refuse(element.label(), std::string(xacro_hint));
  }
  for (const std::string& name : element.attribute_names()) {
    const std::string text = element.attribute(name).value_or("");
    if (text.find("${") != std::string::npos || text.find("$(") != std::string::npos) {
      element.refuse("the expression " + in_quotes(text) + " in " + element.label(), std::string(xacro_hint));
    }
  }
  for (const XmlElement& child : element.children()) {
    refuse_xacro(child);
  }
}

}  // namespace proleg::sim
