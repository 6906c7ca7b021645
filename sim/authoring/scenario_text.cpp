#include "sim/authoring/scenario_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

/// The shortest text of a number that is rounded to a multiple of 1 / per_unit.
std::string rounded_text(double value, double per_unit) {
  const double rounded = std::round(value * per_unit) / per_unit;
  return exact_text(rounded == 0.0 ? 0.0 : rounded);  // no -0
}

constexpr double micro = 1e6;

}  // namespace

std::string number_text_of(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return exact_text(parse_number(text.data()).value_or(value));
}

std::string length_text(double metres) { return rounded_text(std::max(metres, 1.0 / micro), micro); }

std::string coordinate_text(double value) { return rounded_text(value, micro); }

std::string vector_text(const Eigen::Vector3d& vector) {
  return coordinate_text(vector.x()) + " " + coordinate_text(vector.y()) + " " + coordinate_text(vector.z());
}

std::optional<std::string> rotation_text(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  constexpr double no_angle = 1e-9;  // rad
  if (std::abs(turn.angle()) < no_angle) {
    return std::nullopt;
  }
  // Of the two axes the one that mostly points up, forwards or to the right, so that a turn to the right has a negative
  // angle and not an axis that points down.
  Eigen::Index largest = 0;
  turn.axis().cwiseAbs().maxCoeff(&largest);
  const double sense = turn.axis()[largest] < 0.0 ? -1.0 : 1.0;
  constexpr double directions = 1e9;
  std::string text;
  for (const double part : Eigen::Vector3d(sense * turn.axis())) {
    text += rounded_text(part, directions) + " ";
  }
  return text + rounded_text(sense * turn.angle() * 180.0 / std::numbers::pi, micro);
}

std::string element_text(std::string_view tag, std::string_view content) {
  return "<" + std::string(tag) + ">" + escaped(content) + "</" + std::string(tag) + ">";
}

void set_tag(DraftChange& change, const std::string& file, ElementNumber parent, std::string_view tag,
             const std::string& content) {
  const XmlText& xml = change.xml(file);
  if (const auto child = xml.child(parent, tag)) {
    change.apply(file, xml.set_content(*child, content));
  } else {
    change.apply(file, xml.add_last(parent, element_text(tag, content)));
  }
}

std::string unindented(const XmlText& xml, ElementNumber element) {
  const std::size_t begin = xml.at(element).tag.begin;
  const std::size_t column = begin - line_begin(xml.text(), begin);
  std::string result;
  TextLines lines(xml.bytes(element));
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t blanks = std::min(line->find_first_not_of(" \t"), line->size());
    result += result.empty() ? "" : "\n";
    result += line->substr(std::min(blanks, column));
  }
  return result;
}

ElementNumber next_sibling(const XmlText& xml, ElementNumber element) {
  ElementNumber next = element + 1;
  while (next < xml.size() && xml.at(next).tag.begin < xml.at(element).end) {
    ++next;
  }
  return next;
}

}  // namespace proleg::sim
