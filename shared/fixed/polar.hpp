#pragma once

#include <cstdint>

namespace proleg {

/// A vector in polar form.
struct Polar {
  std::int32_t angle;   ///< binary angle from the x axis towards the y axis, 2^32 = one turn; wraps
  std::int32_t length;  ///< in the unit of x and y; not negative
};

/// Polar form of a vector. x and y: in any format, taken as at most 2^29 in size.
///
/// The error of the angle is below 2e-6 turns + 0.4 / length, that of the length below 2e-6 of the length + 15 steps.
/// The length of the zero vector is 0; its angle is 0 to within these errors.
///
/// Method: CORDIC in vectoring mode, 20 steps (J. E. Volder, IRE Trans. Electronic Computers 8, 1959). It needs no
/// division.
[[nodiscard]] Polar polar(std::int32_t x, std::int32_t y);

}  // namespace proleg
