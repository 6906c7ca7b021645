#pragma once

// The only conversion between text and fixed-point numbers. It uses integers only, so every computer reads the same
// bits from the same file.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "shared/fixed/unit.hpp"

namespace proleg {

enum class DecimalError : std::uint8_t {
  none,
  not_a_number,     ///< anything but [+-]digits[.digits][e[+-]digits]; includes "inf", "nan", hexadecimal, blanks
  too_many_digits,  ///< more than 60 significant digits, or an exponent beyond +-60
  out_of_range,     ///< the nearest raw value does not fit int32_t; 2^16 turns or more of a phase
};

struct DecimalResult {
  DecimalError error;
  std::int32_t raw;  ///< 0 unless error is none
};

/// The raw value nearest to the decimal number in `text`, ties to even. A wrapping unit accepts up to 2^16 turns: 235
/// degrees is -125 degrees.
[[nodiscard]] DecimalResult parse_decimal(std::string_view text, Unit unit);

struct DecimalText {
  std::array<char, 32> characters;
  std::size_t size;

  [[nodiscard]] std::string_view view() const { return {characters.data(), size}; }
};

/// The shortest decimal number that parse_decimal() reads back as the same raw value.
[[nodiscard]] DecimalText format_decimal(std::int32_t raw, Unit unit);

}  // namespace proleg
