#pragma once

// Integer arithmetic of all number formats of the core.
//
// Products round in one way only: they are formed in 64 bits and shifted right once, half up. Divisions only derive
// constants, outside the tick, and document their rounding. Sums wrap only in uint32_t and saturate only in functions
// that document it; signed overflow never happens.

#include <cstdint>
#include <limits>
#include <type_traits>

namespace proleg {

/// Nearest multiple of 2^bits, divided by 2^bits: (value + half) >> bits, ties towards plus infinity. bits is 1..62;
/// value must be further than 2^(bits-1) from the ends of int64_t.
[[nodiscard]] constexpr std::int64_t shift_right_rounding(std::int64_t value, unsigned bits) {
  return (value + (std::int64_t{1} << (bits - 1))) >> bits;
}

/// The nearest value that an int32_t can hold.
[[nodiscard]] constexpr std::int32_t saturate(std::int64_t value) {
  // One comparison where nothing saturates: on a Cortex-M that takes fewer instructions than a clamp in 64 bits.
  const auto low = static_cast<std::int32_t>(value);
  if (low == value) {
    return low;
  }
  return static_cast<std::int32_t>(value >> 63) ^ std::numeric_limits<std::int32_t>::max();
}

/// The end of int32_t on the side of a value's sign.
[[nodiscard]] constexpr std::int32_t saturated_towards(std::int32_t value) {
  return (value >> 31) ^ std::numeric_limits<std::int32_t>::max();
}

[[nodiscard]] constexpr std::int32_t add_saturating(std::int32_t a, std::int32_t b) {
  std::int32_t sum = 0;
  const bool overflows = __builtin_add_overflow(a, b, &sum);
  return overflows ? saturated_towards(a) : sum;
}

[[nodiscard]] constexpr std::int32_t subtract_saturating(std::int32_t a, std::int32_t b) {
  std::int32_t difference = 0;
  const bool overflows = __builtin_sub_overflow(a, b, &difference);
  return overflows ? saturated_towards(a) : difference;
}

/// Computes a * b from four products of halves, for processors whose multiplier gives 32 bits only.
[[nodiscard]] constexpr std::uint64_t multiply_by_halves(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t low = (a & 0xFFFFU) * (b & 0xFFFFU);
  const std::uint32_t middle_a = (a >> 16U) * (b & 0xFFFFU) + (low >> 16U);  // at most 2^32 - 2^16
  const std::uint32_t middle_b = (a & 0xFFFFU) * (b >> 16U) + (middle_a & 0xFFFFU);
  const std::uint32_t high = (a >> 16U) * (b >> 16U) + (middle_a >> 16U) + (middle_b >> 16U);
  return (std::uint64_t{high} << 32U) | (middle_b << 16U) | (low & 0xFFFFU);
}

/// The 64-bit product of two 32-bit numbers.
[[nodiscard]] constexpr std::uint64_t multiply_wide(std::uint32_t a, std::uint32_t b) {
#ifdef __ARM_ARCH_6M__  // Cortex-M0: the compiler would call a routine for 64 by 64 bits
  return multiply_by_halves(a, b);
#else
  return std::uint64_t{a} * b;
#endif
}

[[nodiscard]] constexpr std::int64_t multiply_wide(std::int32_t a, std::int32_t b) {
#ifdef __ARM_ARCH_6M__
  const auto bits_a = static_cast<std::uint32_t>(a);
  const auto bits_b = static_cast<std::uint32_t>(b);
  // Read as unsigned, a negative factor is 2^32 too large.
  const std::uint32_t excess = (a < 0 ? bits_b : 0U) + (b < 0 ? bits_a : 0U);
  return static_cast<std::int64_t>(multiply_by_halves(bits_a, bits_b) - (std::uint64_t{excess} << 32U));
#else
  return std::int64_t{a} * b;
#endif
}

/// Product of two fixed-point numbers. One has `fraction_bits` fraction bits; the result has the format of the other.
/// The caller keeps the result within int32_t.
[[nodiscard]] constexpr std::int32_t multiply(std::int32_t a, std::int32_t b, unsigned fraction_bits) {
  return static_cast<std::int32_t>(shift_right_rounding(multiply_wide(a, b), fraction_bits));
}

/// Sum modulo 2^32 of two values that are bit patterns of a wrapping quantity (a phase).
[[nodiscard]] constexpr std::int32_t add_wrapping(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

/// Difference a - b modulo 2^32: for two phases the shortest arc from b to a; an exact half turn is negative.
[[nodiscard]] constexpr std::int32_t subtract_wrapping(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

/// Nearest integer to numerator / denominator, ties away from zero. denominator > 0; the type must hold
/// |numerator| + denominator / 2.
template <typename Integer>
[[nodiscard]] constexpr Integer divide_nearest(Integer numerator, std::type_identity_t<Integer> denominator) {
  const Integer half = denominator / 2;
  return (numerator >= 0 ? numerator + half : numerator - half) / denominator;
}

/// The largest integer whose square is at most `value`. Use it for constants that are derived once, not in every tick.
[[nodiscard]] constexpr std::uint32_t square_root(std::uint64_t value) {
  std::uint64_t rest = value;
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 62U; bit != 0; bit >>= 2U) {
    if (rest >= root + bit) {
      rest -= root + bit;
      root = (root >> 1U) + bit;
    } else {
      root >>= 1U;
    }
  }
  return static_cast<std::uint32_t>(root);
}

}  // namespace proleg
