#include "shared/fixed/decimal.hpp"

#include <limits>

namespace proleg {
namespace {

constexpr int max_digits = 60;
constexpr int max_exponent = 60;
constexpr int max_places = 10;  ///< greatest number of decimal places that format_decimal() writes
constexpr unsigned quotient_bits = 48;
constexpr std::uint64_t max_quotient = std::uint64_t{1} << quotient_bits;

/// Unsigned integer of 512 bits, enough for 60 digits shifted by 60 places and scaled by a unit.
class Natural {
 public:
  explicit Natural(std::uint32_t value) : limbs_{value} {}

  void multiply_add(std::uint32_t factor, std::uint32_t addend) {
    std::uint64_t carry = addend;
    for (std::uint32_t& limb : limbs_) {
      carry += std::uint64_t{limb} * factor;
      limb = static_cast<std::uint32_t>(carry);
      carry >>= 32U;
    }
  }

  void scale_by_power_of_ten(int power) {
    for (int i = 0; i < power; ++i) {
      multiply_add(10, 0);
    }
  }

  void subtract(const Natural& other) {
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const std::uint64_t difference = std::uint64_t{limbs_[i]} - other.limbs_[i] - borrow;
      limbs_[i] = static_cast<std::uint32_t>(difference);
      borrow = (difference >> 32U) & 1U;
    }
  }

  void halve() {
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const std::uint32_t above = i + 1 < limbs_.size() ? limbs_[i + 1] : 0;
      limbs_[i] = (limbs_[i] >> 1U) | (above << 31U);
    }
  }

  [[nodiscard]] int compare(const Natural& other) const {
    for (std::size_t i = limbs_.size(); i-- > 0;) {
      if (limbs_[i] != other.limbs_[i]) {
        return limbs_[i] < other.limbs_[i] ? -1 : 1;
      }
    }
    return 0;
  }

 private:
  std::array<std::uint32_t, 16> limbs_;
};

/// Nearest integer to numerator / denominator, ties to even; at most 2^48, a larger quotient is returned as 2^48.
std::uint64_t divide_half_even(Natural numerator, const Natural& denominator) {
  Natural multiple = denominator;
  for (unsigned i = 0; i < quotient_bits; ++i) {
    multiple.multiply_add(2, 0);
  }
  if (numerator.compare(multiple) >= 0) {
    return max_quotient;
  }
  std::uint64_t quotient = 0;
  for (unsigned i = quotient_bits; i-- > 0;) {
    multiple.halve();
    quotient <<= 1U;
    if (numerator.compare(multiple) >= 0) {
      numerator.subtract(multiple);
      quotient |= 1U;
    }
  }
  numerator.multiply_add(2, 0);
  const int half = numerator.compare(denominator);
  if (half > 0 || (half == 0 && (quotient & 1U) != 0)) {
    ++quotient;
  }
  return quotient;
}

/// A decimal number as it is written: sign, digits without the point, and number of places after the point.
struct Decimal {
  bool negative = false;
  Natural digits{0};
  int places = 0;
};

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  DecimalError read(Decimal& number) {
    if (skip('-')) {
      number.negative = true;
    } else {
      skip('+');
    }
    int digits_read = 0;
    int significant = 0;
    bool after_point = false;
    for (; !at_end(); ++position_) {
      const char c = text_[position_];
      if (c == '.' && !after_point) {
        after_point = true;
        continue;
      }
      if (!is_digit(c)) {
        break;
      }
      ++digits_read;
      number.places += after_point ? 1 : 0;
      significant += (significant > 0 || c != '0') ? 1 : 0;
      if (significant > max_digits || number.places > max_digits) {
        return DecimalError::too_many_digits;
      }
      number.digits.multiply_add(10, static_cast<std::uint32_t>(c - '0'));
    }
    if (digits_read == 0) {
      return DecimalError::not_a_number;
    }
    if (skip('e') || skip('E')) {
      if (const DecimalError error = read_exponent(number); error != DecimalError::none) {
        return error;
      }
    }
    return at_end() ? DecimalError::none : DecimalError::not_a_number;
  }

 private:
  DecimalError read_exponent(Decimal& number) {
    const bool negative = skip('-');
    if (!negative) {
      skip('+');
    }
    if (at_end()) {
      return DecimalError::not_a_number;
    }
    int exponent = 0;
    for (; !at_end() && is_digit(text_[position_]); ++position_) {
      exponent = exponent * 10 + (text_[position_] - '0');
      if (exponent > max_exponent) {
        return DecimalError::too_many_digits;
      }
    }
    number.places += negative ? exponent : -exponent;
    return DecimalError::none;
  }

  [[nodiscard]] bool at_end() const { return position_ == text_.size(); }
  bool skip(char c) {
    if (!at_end() && text_[position_] == c) {
      ++position_;
      return true;
    }
    return false;
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

/// Writes a number. places: how many of the digits are after the point.
DecimalText text_of(bool negative, std::uint64_t digits, int places) {
  DecimalText text{{}, 0};
  std::array<char, 24> reversed{};
  std::size_t length = 0;
  for (int i = 0; digits > 0 || i <= places; ++i) {
    if (i == places && places > 0) {
      reversed[length++] = '.';
    }
    reversed[length++] = static_cast<char>('0' + digits % 10);
    digits /= 10;
  }
  if (negative) {
    text.characters[text.size++] = '-';
  }
  while (length > 0) {
    text.characters[text.size++] = reversed[--length];
  }
  return text;
}

}  // namespace

DecimalResult parse_decimal(std::string_view text, Unit unit) {
  Decimal number;
  if (const DecimalError error = Scanner(text).read(number); error != DecimalError::none) {
    return {error, 0};
  }
  const UnitScale scale = scale_of(unit);
  Natural numerator = number.digits;
  numerator.multiply_add(scale.numerator, 0);
  Natural denominator(scale.denominator);
  if (number.places >= 0) {
    denominator.scale_by_power_of_ten(number.places);
  } else {
    numerator.scale_by_power_of_ten(-number.places);
  }
  const std::uint64_t magnitude = divide_half_even(numerator, denominator);
  constexpr std::uint64_t beyond = std::uint64_t{1} << 31U;
  const bool fits =
      wraps(unit) ? magnitude < max_quotient : magnitude < beyond || (magnitude == beyond && number.negative);
  if (!fits) {
    return {DecimalError::out_of_range, 0};
  }
  const auto value = static_cast<std::uint32_t>(magnitude);
  return {DecimalError::none, static_cast<std::int32_t>(number.negative ? 0U - value : value)};
}

DecimalText format_decimal(std::int32_t raw, Unit unit) {
  const UnitScale scale = scale_of(unit);
  const auto magnitude = raw < 0 ? 0U - static_cast<std::uint32_t>(raw) : static_cast<std::uint32_t>(raw);
  // The number is value / scale.numerator. 10 places resolve the finest unit (2^-28) with digits to spare, and with its
  // whole part removed each product below fits 64 bits.
  const std::uint64_t value = std::uint64_t{magnitude} * scale.denominator;
  const std::uint64_t rest = value % scale.numerator;
  std::uint64_t power = 1;
  for (int places = 0;; ++places, power *= 10) {
    std::uint64_t digits = value / scale.numerator * power + rest * power / scale.numerator;
    const std::uint64_t remainder = rest * power % scale.numerator;
    const bool is_up = 2 * remainder > scale.numerator || (2 * remainder == scale.numerator && (digits & 1U) != 0);
    digits += is_up ? 1U : 0U;
    // The digits differ from the value by this part of a step; parse_decimal() rounds half a step to the even raw
    // value.
    const std::uint64_t twice_error = 2 * (is_up ? scale.numerator - remainder : remainder);
    const std::uint64_t step = scale.denominator * power;
    if (places == max_places || twice_error < step || (twice_error == step && magnitude % 2 == 0)) {
      return text_of(raw < 0, digits, places);
    }
  }
}

}  // namespace proleg
