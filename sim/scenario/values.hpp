#pragma once

// Numbers and names out of elements, with the ranges that hold everywhere. The ranges are generous; they exist so that
// no sum, product or matrix of a scenario overflows or degenerates.

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Lowest and highest allowed value, both included.
struct Range {
  double lowest;
  double highest;
  std::string_view unit;
};

inline constexpr Range coordinates{-1e4, 1e4, "m"};
inline constexpr Range lengths{1e-6, 1e4, "m"};
inline constexpr Range masses{1e-6, 1e4, "kg"};
inline constexpr Range densities{1e-9, 1e9, "kg/m^3"};
inline constexpr Range frictions{0.0, 1e3, ""};

/// One number, which is all that the element holds besides these attributes.
[[nodiscard]] double read_number(const XmlElement& element, const Range& range,
                                 std::initializer_list<std::string_view> attributes = {});

/// As read_number; an attribute `unit` may say the unit, but no other than that of the range.
[[nodiscard]] double read_quantity(const XmlElement& element, const Range& range);

/// A number that an attribute holds.
[[nodiscard]] double read_number_attribute(const XmlElement& element, std::string_view attribute, const Range& range);

/// A whole number from lowest to highest, which is all that the element holds.
[[nodiscard]] std::uint64_t read_whole(const XmlElement& element, std::uint64_t lowest, std::uint64_t highest);
[[nodiscard]] std::uint64_t read_whole_attribute(const XmlElement& element, std::string_view attribute,
                                                 std::uint64_t lowest, std::uint64_t highest);

/// Position of the only word that the element holds, in any case, among these words in lower case.
[[nodiscard]] std::size_t read_choice(const XmlElement& element, std::initializer_list<std::string_view> words);
[[nodiscard]] std::size_t read_choice_attribute(const XmlElement& element, std::string_view attribute,
                                                std::initializer_list<std::string_view> words);

/// `count` numbers.
[[nodiscard]] std::vector<double> read_numbers(const XmlElement& element, std::size_t count, const Range& range);

[[nodiscard]] Eigen::Vector3d read_vector(const XmlElement& element, const Range& range);

/// A name of 1 to 64 characters.
[[nodiscard]] std::string checked_name(const XmlElement& element, std::string name);

/// The tags that read_pose understands.
inline constexpr std::array<std::string_view, 3> pose_tags{"translation", "rotationaxis", "quat"};

/// The pose that the <translation>, <rotationaxis> (x y z degrees) and <quat> (w x y z) of an element say. As in
/// OpenRAVE, translations add up, and each rotation is applied after those before it; the two do not mix.
[[nodiscard]] Pose read_pose(const XmlElement& element);

/// The lists joined, for XmlElement::allow.
[[nodiscard]] std::vector<std::string_view> joined(std::initializer_list<std::span<const std::string_view>> lists);

/// Adds the remark that an element is accepted but does nothing.
void remark_no_effect(std::vector<std::string>& remarks, const XmlElement& element, std::string_view reason);

}  // namespace proleg::sim
