#include "shared/fixed/sine.hpp"

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

// Coefficients of sin(pi/2 x) = x (c1 - x^2 (c3 - x^2 (c5 - x^2 (c7 - x^2 c9)))), found by linear programming on 4000
// Chebyshev points for the smallest largest error with value 1 and slope 0 at x = 1. All brackets are positive, so
// everything is unsigned. Each level multiplies by x^2 in Q31 and keeps the high word, which halves; the coefficients
// carry that factor: Q31 for c1, then Q32, Q33, Q34, Q35. c1 is nudged so that the crest comes out exactly.
constexpr std::uint32_t c1 = 3373259290U;
constexpr std::uint32_t c3 = 2774389723U;
constexpr std::uint32_t c5 = 684504745U;
constexpr std::uint32_t c7 = 80228237U;
constexpr std::uint32_t c9 = 5145016U;

/// High word of the product, rounded half up; the compiler makes one UMLAL of it on Cortex-M4.
constexpr std::uint32_t multiply_high(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>((multiply_wide(a, b) + 0x80000000U) >> 32U);
}

}  // namespace

std::int32_t sine(std::uint32_t phase) {
  // The phase is folded before it is rounded, so that the result is exactly odd. In the second and third quarter (bits
  // 31 and 30 differ) the distance to half a turn has the same sine.
  const bool beyond_crest = ((phase ^ (phase << 1U)) & 0x80000000U) != 0;
  const auto quarter = static_cast<std::int32_t>(beyond_crest ? 0x80000000U - phase : phase);
  const bool negative = quarter < 0;
  const auto magnitude = static_cast<std::uint32_t>(negative ? -quarter : quarter);

  const std::uint32_t x = magnitude << 1U;  // Q31: the crest is 2^31
  const auto x2 = static_cast<std::uint32_t>((multiply_wide(x, x) + 0x40000000U) >> 31U);
  const std::uint32_t slope =
      c1 - multiply_high(x2, c3 - multiply_high(x2, c5 - multiply_high(x2, c7 - multiply_high(x2, c9))));
  const auto result = static_cast<std::int32_t>(multiply_high(x, slope));
  return negative ? -result : result;
}

}  // namespace proleg
