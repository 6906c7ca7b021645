#include "sim/authoring/scenario_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

/// The shortest text of a number that is rounded to a multiple of 1 / per_unit.
std::string rounded_text(double value, double per_unit) {
  const double rounded = std::round(value * per_unit) / per_unit;
  return exact_text(rounded == 0.0 ? 0.0 : rounded);  // no -0
}

constexpr double micro = 1e6;

constexpr std::array<std::string_view, 3> rotation_tags{"rotationaxis", "quat", "rotationmat"};

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
  constexpr double per_unit = 1e9;
  std::string text;
  for (const double part : Eigen::Vector3d(sense * turn.axis())) {
    text += rounded_text(part, per_unit) + " ";
  }
  return text + rounded_text(sense * turn.angle() * 180.0 / std::numbers::pi, micro);
}

std::string element_text(std::string_view tag, std::string_view content) {
  return "<" + std::string(tag) + ">" + escaped_xml(content) + "</" + std::string(tag) + ">";
}

std::string content_of(const XmlText& xml, ElementNumber element) {
  const XmlDocument document(xml.name(), std::string(xml.bytes(element)), nullptr);
  return document.root(xml.at(element).tag.name).text();
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

Pose pose_of(const XmlText& xml, ElementNumber element) {
  const XmlDocument document(xml.name(), std::string(xml.bytes(element)), nullptr);
  return read_pose(document.root(xml.at(element).tag.name));
}

void set_pose(DraftChange& change, const std::string& file, ElementNumber element, const Pose& pose) {
  const auto xml = [&]() -> const XmlText& { return change.xml(file); };
  const auto apply = [&](const TextPatch& patch) { change.apply(file, patch); };
  const Pose before = pose_of(xml(), element);
  const std::string position = vector_text(pose.position);
  if (const auto translations = xml().children(element, "translation"); !translations.empty()) {
    for (std::size_t i = translations.size(); i-- > 1;) {
      apply(xml().remove(translations[i]));
    }
    apply(xml().set_content(translations.front(), position));
  } else if (!pose.position.isZero(1e-9)) {
    apply(xml().add_first(element, element_text("Translation", position)));
  }
  constexpr double same_angle = 1e-9;  // rad
  if (before.orientation.angularDistance(pose.orientation) < same_angle) {
    return;
  }
  std::vector<ElementNumber> rotations;
  for (const ElementNumber child : xml().children(element)) {
    if (std::ranges::any_of(rotation_tags, [&](std::string_view tag) { return xml().is(child, tag); })) {
      rotations.push_back(child);
    }
  }
  const std::optional<std::string> rotation = rotation_text(pose.orientation);
  for (std::size_t i = rotations.size(); i-- > (rotation ? 1U : 0U);) {
    apply(xml().remove(rotations[i]));
  }
  if (!rotation) {
    return;
  }
  const std::string tag = element_text("RotationAxis", *rotation);
  if (!rotations.empty()) {
    const XmlText::Element& first = xml().at(rotations.front());
    apply(xml().replace({first.tag.begin, first.end}, tag));
  } else if (const auto translation = xml().child(element, "translation")) {
    apply(xml().add_behind(*translation, tag));
  } else {
    apply(xml().add_first(element, tag));
  }
}

void set_mass_of(DraftChange& change, const std::string& file, ElementNumber mass_element, double mass) {
  const XmlText& xml = change.xml(file);
  if (xml.child(mass_element, "inertia")) {
    throw InputError("mass", 0, "an <inertia> in " + file + ":" + std::to_string(xml.at(mass_element).tag.line),
                     "a mass whose inertia follows from its shape");
  }
  if (const auto density = xml.child(mass_element, "density")) {
    const XmlText::Element& tag = xml.at(*density);
    change.apply(file, xml.replace({tag.tag.begin, tag.end}, element_text("total", number_text_of(mass))));
  } else {
    set_tag(change, file, mass_element, "total", number_text_of(mass));
  }
}

void set_friction_of(DraftChange& change, const std::string& file, ElementNumber geometry,
                     std::optional<double> friction) {
  if (friction) {
    set_tag(change, file, geometry, "friction", number_text_of(*friction));
  } else if (const auto tag = change.xml(file).child(geometry, "friction")) {
    change.apply(file, change.xml(file).remove(*tag));
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
