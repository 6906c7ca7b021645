#pragma once

#include <cstdint>

namespace proleg {

/// Sine of a binary angle.
///
/// phase: 2^32 = one turn. Result: Q30, in [-2^30, 2^30]. The function is odd to the last bit, exactly 0 at multiples
/// of half a turn and exactly +-2^30 at the crests. Over a rising quarter it never steps back by more than 1 lsb. The
/// largest error over all 2^32 inputs is 7.3e-9, 8 lsb (tests/shared/fixed/sine_test.cpp).
///
/// Method: fold to a quarter turn, then an odd polynomial of degree 9 that is the minimax approximation under the two
/// conditions value 1 and slope 0 at the crest.
[[nodiscard]] std::int32_t sine(std::uint32_t phase);

/// Cosine of a binary angle, with the format and the errors of sine().
[[nodiscard]] inline std::int32_t cosine(std::uint32_t phase) { return sine(phase + 0x40000000U); }

}  // namespace proleg
