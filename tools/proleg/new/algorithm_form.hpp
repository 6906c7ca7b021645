#pragma once

// What a person says about a new algorithm before its source is written, and the rules of docs/user-algorithms.md for
// it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "shared/gait/declaration.hpp"

namespace proleg::tools {

struct FormParameter {
  std::string name;
  Unit unit = Unit::ratio;
  // Decimal numbers in the unit.
  std::string minimum;
  std::string usual;  ///< the default
  std::string maximum;
  std::string help;
};

struct FormValue {
  std::string name;
  Unit unit = Unit::ratio;
  std::string help;
};

struct AlgorithmForm {
  std::string name;
  std::uint8_t id = first_user_id;
  std::string help;
  std::vector<FormParameter> parameters;
  std::vector<FormValue> values;  ///< internal values, without those that each pattern generator has
  bool senses_touch = false;
};

/// The form of the shipped example: a travelling sine with a second harmonic.
[[nodiscard]] AlgorithmForm example_form(const std::string& name, std::uint8_t id);

/// Whether the source of a form is a travelling wave: it has amplitude, frequency and phase_difference in their units.
/// Else its joints stay at 0 degrees until the person writes something else.
[[nodiscard]] bool is_wave(const AlgorithmForm& form);
/// Whether the wave has a second harmonic: there is a ratio `steepness`, too.
[[nodiscard]] bool has_harmonic(const AlgorithmForm& form);
/// Whether the parameters and internal values are those of the example.
[[nodiscard]] bool has_values_of_example(const AlgorithmForm& form);

/// A value of a form: raw, or why it is none. is_maximum: 180 degrees of a phase are the largest one, not the smallest.
[[nodiscard]] std::optional<std::int32_t> form_value(const std::string& text, Unit unit, bool is_maximum = false);

/// Checks the name of an algorithm: letters, digits and single _, no word that C++ or the example needs, and no
/// algorithm of the program. field: for the message. Throws InputError.
void check_algorithm_name(const std::string& name, std::size_t longest, const std::string& field);

/// Checks all rules that hold before anything is compiled. Throws InputError, whose file is the field: "id",
/// "parameters.0.minimum".
void check_form(const AlgorithmForm& form);

/// The id that follows from a name: algorithms with different names rarely have the same one.
[[nodiscard]] std::uint8_t usual_id(const std::string& name);

}  // namespace proleg::tools
