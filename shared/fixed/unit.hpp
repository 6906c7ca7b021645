#pragma once

// The physical units of everything that has a name: parameters, internal values, joint angles. A value is an int32_t
// ("raw"); its unit says how much one step of it is.

#include <cstdint>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

enum class Unit : std::uint8_t {
  degree,        ///< angle; 90 degrees = 2^30; saturates
  phase_degree,  ///< binary angle; 2^32 = one turn; wraps; 180 and -180 are the same phase
  hertz,         ///< 1 Hz = 2^24
  per_second,    ///< rate constants; 1/s = 2^24
  ratio,         ///< dimensionless; 1 = 2^28
  count,         ///< whole numbers
};

/// The scale of a unit: raw = value * numerator / denominator.
struct UnitScale {
  const char* symbol;
  std::uint32_t numerator;
  std::uint32_t denominator;
};

[[nodiscard]] constexpr UnitScale scale_of(Unit unit) {
  switch (unit) {
    case Unit::degree:
    case Unit::phase_degree:
      return {"deg", 1U << 29U, 45};
    case Unit::hertz:
      return {"Hz", 1U << 24U, 1};
    case Unit::per_second:
      return {"1/s", 1U << 24U, 1};
    case Unit::ratio:
      return {"1", 1U << 28U, 1};
    case Unit::count:
      break;
  }
  return {"", 1, 1};
}

/// Whether values of the unit are taken modulo 2^32.
[[nodiscard]] constexpr bool wraps(Unit unit) { return unit == Unit::phase_degree; }

/// The raw value nearest to a quotient of whole numbers, for use in declarations: raw(Unit::hertz, 1, 2) is half a
/// hertz.
[[nodiscard]] constexpr std::int32_t raw(Unit unit, std::int32_t numerator, std::int32_t denominator = 1) {
  const UnitScale scale = scale_of(unit);
  return static_cast<std::int32_t>(
      divide_nearest(std::int64_t{numerator} * scale.numerator, std::int64_t{denominator} * scale.denominator));
}

}  // namespace proleg
