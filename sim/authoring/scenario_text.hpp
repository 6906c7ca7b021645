#pragma once

// Numbers, vectors and elements as text of scenario files.

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/xml_text.hpp"
#include "sim/robot/pose.hpp"

namespace proleg::sim {

/// A number without more digits than a person needs: rounded to nine significant ones.
[[nodiscard]] std::string number_text_of(double value);
/// Metres, rounded to micrometres; at least one micrometre if it is above 0.
[[nodiscard]] std::string length_text(double metres);
/// Metres or degrees, rounded to millionths.
[[nodiscard]] std::string coordinate_text(double value);
/// "x y z", each as coordinate_text().
[[nodiscard]] std::string vector_text(const Eigen::Vector3d& vector);
/// "x y z degrees" for <RotationAxis>; nothing for no rotation.
[[nodiscard]] std::optional<std::string> rotation_text(const Eigen::Quaterniond& rotation);
/// "<tag>content</tag>"
[[nodiscard]] std::string element_text(std::string_view tag, std::string_view content);

/// What stands between the tags of an element, as the reader has it.
[[nodiscard]] std::string content_of(const XmlText& xml, ElementNumber element);

/// Sets the content of a child of an element, or adds the child as the last one.
void set_tag(DraftChange& change, const std::string& file, ElementNumber parent, std::string_view tag,
             const std::string& content);

/// The pose that the tags of an element give it in the frame around it (read_pose()).
[[nodiscard]] Pose pose_of(const XmlText& xml, ElementNumber element);
/// Gives an element this pose in the frame around it. A rotation that is as it should be keeps its tags.
void set_pose(DraftChange& change, const std::string& file, ElementNumber element, const Pose& pose);

/// Sets the total of a <Mass>, in kg; the inertia follows from the shape. Throws InputError if the element has an
/// inertia of its own.
void set_mass_of(DraftChange& change, const std::string& file, ElementNumber mass_element, double mass);

/// Sets the coefficient of a <Geom>; nothing: it has none of its own.
void set_friction_of(DraftChange& change, const std::string& file, ElementNumber geometry,
                     std::optional<double> friction);

/// The lines of an element without its indentation, as XmlText::add_behind() takes them.
[[nodiscard]] std::string unindented(const XmlText& xml, ElementNumber element);
/// The element directly behind another one in the same parent. There is one.
[[nodiscard]] ElementNumber next_sibling(const XmlText& xml, ElementNumber element);

}  // namespace proleg::sim
