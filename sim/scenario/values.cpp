#include "sim/scenario/values.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr Range angles{-1e4, 1e4, "degrees"};
constexpr double min_direction = 1e-6;
constexpr std::array<std::string_view, 4> switch_words{"true", "1", "false", "0"};
constexpr std::size_t count_of_true = 2;  ///< of these words

std::string described(const Range& range) {
  return number_text(range.min) + " to " + number_text(range.max) +
         (range.unit.empty() ? "" : " " + std::string(range.unit));
}

/// The text of an element or attribute, and how a message names it with its place.
struct LocatedText {
  std::string text;
  std::string in_message;
};

LocatedText text_of(const XmlElement& element) {
  return {element.text(), in_quotes(element.text()) + " in " + element.label()};
}

LocatedText attribute_of(const XmlElement& element, std::string_view attribute) {
  std::string text = element.required_attribute(attribute);
  std::string in_message = std::string(attribute) + " " + in_quotes(text) + " in " + element.label();
  return {std::move(text), std::move(in_message)};
}

double checked_number(const XmlElement& element, std::string_view word, const std::string& in_message,
                      const Range& range) {
  const std::optional<double> value = parse_number(word);
  if (!value || *value < range.min || *value > range.max) {
    element.refuse(in_message, "a number from " + described(range));
  }
  return *value;
}

double checked_number(const XmlElement& element, std::string_view word, const Range& range) {
  return checked_number(element, word, in_quotes(word) + " in " + element.label(), range);
}

std::uint64_t checked_whole(const XmlElement& element, const LocatedText& located, std::uint64_t min,
                            std::uint64_t max) {
  const std::string_view unsigned_text = std::string_view(located.text).substr(located.text.starts_with('+') ? 1 : 0);
  const std::optional<std::uint64_t> value = parse_whole<std::uint64_t>(unsigned_text);
  if (!value || *value < min || *value > max) {
    element.refuse(located.in_message, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return *value;
}

std::size_t checked_choice(const XmlElement& element, const LocatedText& located,
                           std::span<const std::string_view> words) {
  const auto found = std::ranges::find(words, lower_case(located.text));
  if (found == words.end()) {
    std::string known;
    for (std::size_t i = 0; i < words.size(); ++i) {
      known += (i == 0 ? "'" : i + 1 == words.size() ? " or '" : ", '") + std::string(words[i]) + "'";
    }
    element.refuse(located.in_message, known);
  }
  return static_cast<std::size_t>(found - words.begin());
}

/// Of nine numbers, row by row. Files have them with three digits or more.
Eigen::Quaterniond read_rotation_matrix(const XmlElement& element) {
  const std::vector<double> numbers = read_numbers(element, 9, directions);
  const Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  constexpr double tolerance = 0.01;
  if (!(matrix * matrix.transpose()).isIdentity(tolerance) || matrix.determinant() < 0.0) {
    element.refuse(in_quotes(element.text()) + " in " + element.label(),
                   "a rotation, row by row: rows of length 1 that are perpendicular to each other, with determinant 1");
  }
  return Eigen::Quaterniond(matrix).normalized();
}

/// Whether a name has U+202A to U+202E or U+2066 to U+2069.
bool turns_direction(std::string_view name) {
  for (std::size_t i = 0; i + 2 < name.size(); ++i) {
    const std::string_view start = name.substr(i, 2);
    const auto last = static_cast<unsigned char>(name[i + 2]);
    if ((start == "\xE2\x80" && last >= 0xAA && last <= 0xAE) ||
        (start == "\xE2\x81" && last >= 0xA6 && last <= 0xA9)) {
      return true;
    }
  }
  return false;
}

void add_remark(std::vector<std::string>& remarks, const XmlElement& element, const std::string& what,
                std::string_view reason) {
  remarks.push_back(one_line(element.document().name() + ":" + std::to_string(element.line()) + ": " + what +
                             " has no effect: " + std::string(reason)));
}

}  // namespace

std::optional<double> parse_number_in(std::string_view word, const Range& range) {
  const std::optional<double> value = parse_number(word);
  return value && *value >= range.min && *value <= range.max ? value : std::nullopt;
}

double read_number(const XmlElement& element, const Range& range, std::initializer_list<std::string_view> attributes) {
  return checked_number(element, element.text(attributes), range);
}

double read_number_attribute(const XmlElement& element, std::string_view attribute, const Range& range) {
  const LocatedText located = attribute_of(element, attribute);
  return checked_number(element, located.text, located.in_message, range);
}

std::uint64_t read_whole(const XmlElement& element, std::uint64_t min, std::uint64_t max) {
  return checked_whole(element, text_of(element), min, max);
}

std::uint64_t read_whole_attribute(const XmlElement& element, std::string_view attribute, std::uint64_t min,
                                   std::uint64_t max) {
  return checked_whole(element, attribute_of(element, attribute), min, max);
}

std::size_t read_choice(const XmlElement& element, std::span<const std::string_view> words) {
  return checked_choice(element, text_of(element), words);
}

std::size_t read_choice(const XmlElement& element, std::initializer_list<std::string_view> words) {
  return read_choice(element, std::span(words.begin(), words.size()));
}

std::size_t read_choice_attribute(const XmlElement& element, std::string_view attribute,
                                  std::initializer_list<std::string_view> words) {
  return checked_choice(element, attribute_of(element, attribute), std::span(words.begin(), words.size()));
}

bool read_switch(const XmlElement& element) {
  return checked_choice(element, text_of(element), switch_words) < count_of_true;
}

bool read_switch_attribute(const XmlElement& element, std::string_view attribute) {
  return checked_choice(element, attribute_of(element, attribute), switch_words) < count_of_true;
}

double read_quantity(const XmlElement& element, const Range& range) {
  const double value = read_number(element, range, {"unit"});
  if (const auto unit = element.attribute("unit"); unit && *unit != range.unit) {
    element.refuse("unit " + in_quotes(*unit) + " in " + element.label(), "unit '" + std::string(range.unit) + "'");
  }
  return value;
}

std::uint32_t read_microseconds(const XmlElement& element, const Range& milliseconds) {
  const double microseconds = read_quantity(element, milliseconds) * 1000.0;
  if (std::abs(microseconds - std::round(microseconds)) > 1e-6) {
    element.refuse(in_quotes(element.text({"unit"})) + " in " + element.label(), "a whole number of microseconds");
  }
  return static_cast<std::uint32_t>(std::round(microseconds));
}

std::vector<double> read_numbers(const XmlElement& element, std::size_t count, const Range& range) {
  const std::string text = element.text();
  const std::vector<std::string_view> tokens = words(text);
  if (tokens.size() != count) {
    element.refuse(in_quotes(text) + " in " + element.label(), std::to_string(count) + " numbers");
  }
  std::vector<double> result;
  result.reserve(count);
  for (const std::string_view token : tokens) {
    result.push_back(checked_number(element, token, range));
  }
  return result;
}

Eigen::Vector3d read_vector(const XmlElement& element, const Range& range) {
  const std::vector<double> numbers = read_numbers(element, 3, range);
  return {numbers[0], numbers[1], numbers[2]};
}

std::string checked_name(const XmlElement& element, std::string name) {
  constexpr std::size_t max_name_size = 64;
  if (name.empty() || name.size() > max_name_size) {
    element.refuse(name.empty() ? "an empty name in " + element.label() : "the long name " + in_quotes(name),
                   "a name of 1 to " + std::to_string(max_name_size) + " characters");
  }
  if (one_line(name) != name) {
    element.refuse("control characters in the name " + in_quotes(name), "a name of one line");
  }
  if (turns_direction(name)) {
    element.refuse("a character that turns the direction of text in the name " + in_quotes(name),
                   "a name without it, which would exchange what is beside it in tables");
  }
  return name;
}

Pose read_pose(const XmlElement& element) {
  Pose pose;
  for (const XmlElement& child : element.children()) {
    if (child.is("translation")) {
      pose.position += read_vector(child, coordinates);
    } else if (child.is("rotationaxis")) {
      const std::vector<double> numbers = read_numbers(child, 4, angles);
      const Eigen::Vector3d axis(numbers[0], numbers[1], numbers[2]);
      if (axis.norm() < min_direction) {
        child.refuse(in_quotes(child.text()) + " in " + child.label(), "an axis that is not 0, and degrees");
      }
      const double angle = numbers[3] * std::numbers::pi / 180.0;
      pose.orientation = Eigen::AngleAxisd(angle, axis.normalized()) * pose.orientation;
    } else if (child.is("quat")) {
      const std::vector<double> numbers = read_numbers(child, 4, directions);
      const Eigen::Quaterniond rotation(numbers[0], numbers[1], numbers[2], numbers[3]);
      if (rotation.norm() < min_direction) {
        child.refuse(in_quotes(child.text()) + " in " + child.label(), "a quaternion w x y z that is not 0");
      }
      pose.orientation = rotation.normalized() * pose.orientation;
    } else if (child.is("rotationmat")) {
      pose.orientation = read_rotation_matrix(child) * pose.orientation;
    }
  }
  pose.orientation.normalize();
  return pose;
}

std::vector<std::string_view> joined(std::initializer_list<std::span<const std::string_view>> lists) {
  std::vector<std::string_view> result;
  for (const auto list : lists) {
    result.insert(result.end(), list.begin(), list.end());
  }
  return result;
}

void remark_no_effect(std::vector<std::string>& remarks, const XmlElement& element, std::string_view reason) {
  add_remark(remarks, element, element.label(), reason);
}

void remark_no_effect_of(std::string_view attribute, std::vector<std::string>& remarks, const XmlElement& element,
                         std::string_view reason) {
  add_remark(remarks, element, "attribute '" + std::string(attribute) + "' in " + element.label(), reason);
}

}  // namespace proleg::sim
