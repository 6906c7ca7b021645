#pragma once

// Numbers, vectors and elements as text of scenario files.

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/xml_text.hpp"

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

/// Sets the content of a child of an element, or adds the child as the last one.
void set_tag(DraftChange& change, const std::string& file, ElementNumber parent, std::string_view tag,
             const std::string& content);

/// The lines of an element without its indentation, as XmlText::add_behind() takes them.
[[nodiscard]] std::string unindented(const XmlText& xml, ElementNumber element);
/// The element directly behind another one in the same parent. There is one.
[[nodiscard]] ElementNumber next_sibling(const XmlText& xml, ElementNumber element);

}  // namespace proleg::sim
