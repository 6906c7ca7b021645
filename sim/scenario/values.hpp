#pragma once

// Reads numbers and names from elements. The ranges are the same everywhere and generous; they ensure that no sum,
// product or matrix of a scenario overflows or degenerates.

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Allowed values, bounds included.
struct Range {
  double min;
  double max;
  std::string_view unit;
};

inline constexpr Range directions{-1e4, 1e4, ""};  ///< each component, also of a quaternion
inline constexpr Range coordinates{-1e4, 1e4, "m"};
inline constexpr Range lengths{1e-6, 1e4, "m"};
inline constexpr Range masses{1e-6, 1e4, "kg"};
inline constexpr Range densities{1e-9, 1e9, "kg/m^3"};
inline constexpr Range frictions{0.0, 1e3, ""};

inline constexpr Range turns{-360.0, 360.0, "degrees"};

/// The whole word as a number in the range, or nothing.
[[nodiscard]] std::optional<double> parse_number_in(std::string_view word, const Range& range);

/// One number; the element may have only these attributes besides.
[[nodiscard]] double read_number(const XmlElement& element, const Range& range,
                                 std::initializer_list<std::string_view> attributes = {});

/// Reads a number as read_number does; an attribute `unit` is optional and must be the unit of the range.
[[nodiscard]] double read_quantity(const XmlElement& element, const Range& range);

/// A quantity in ms that is a whole number of microseconds.
[[nodiscard]] std::uint32_t read_microseconds(const XmlElement& element, const Range& milliseconds);

/// The number in an attribute.
[[nodiscard]] double read_number_attribute(const XmlElement& element, std::string_view attribute, const Range& range);

/// A whole number from min to max, the only content of the element.
[[nodiscard]] std::uint64_t read_whole(const XmlElement& element, std::uint64_t min, std::uint64_t max);
[[nodiscard]] std::uint64_t read_whole_attribute(const XmlElement& element, std::string_view attribute,
                                                 std::uint64_t min, std::uint64_t max);

/// Position of the element's only word, in any case, among these words in lower case.
[[nodiscard]] std::size_t read_choice(const XmlElement& element, std::span<const std::string_view> words);
[[nodiscard]] std::size_t read_choice(const XmlElement& element, std::initializer_list<std::string_view> words);
[[nodiscard]] std::size_t read_choice_attribute(const XmlElement& element, std::string_view attribute,
                                                std::initializer_list<std::string_view> words);

/// Whether the element's only word, or an attribute, is "true" or "1"; the other words are "false" and "0".
[[nodiscard]] bool read_switch(const XmlElement& element);
[[nodiscard]] bool read_switch_attribute(const XmlElement& element, std::string_view attribute);

/// `count` numbers.
[[nodiscard]] std::vector<double> read_numbers(const XmlElement& element, std::size_t count, const Range& range);

[[nodiscard]] Eigen::Vector3d read_vector(const XmlElement& element, const Range& range);

/// A name of 1 to 64 characters.
[[nodiscard]] std::string checked_name(const XmlElement& element, std::string name);

/// The tags that read_pose reads.
inline constexpr std::array<std::string_view, 4> pose_tags{"translation", "rotationaxis", "quat", "rotationmat"};

/// The pose given by the <translation>, <rotationaxis> (x y z degrees), <quat> (w x y z) and <rotationmat> (nine
/// numbers row by row) of an element. As in OpenRAVE, translations add up, each rotation is applied after those before
/// it, and rotations do not turn translations.
[[nodiscard]] Pose read_pose(const XmlElement& element);

/// The lists joined, for XmlElement::allow.
[[nodiscard]] std::vector<std::string_view> joined(std::initializer_list<std::span<const std::string_view>> lists);

/// Adds the remark that an element is accepted but has no effect.
void remark_no_effect(std::vector<std::string>& remarks, const XmlElement& element, std::string_view reason);

/// Adds the remark that an attribute is accepted but has no effect.
void remark_no_effect_of(std::string_view attribute, std::vector<std::string>& remarks, const XmlElement& element,
                         std::string_view reason);

}  // namespace proleg::sim
