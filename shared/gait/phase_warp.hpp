#pragma once

#include <cstdint>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

/// The two speeds of an oscillator whose first half turn lasts a fraction d of the period, the second the rest. Maps
/// between the phase of the clock, which is uniform in time, and the angle of the oscillator. For d = 1/2 both are the
/// same, to the last bit.
class PhaseWarp {
 public:
  /// Number of derived constants that a warp takes up.
  static constexpr unsigned derived_size = 2;

  /// fraction: d in Q28, between 0 and 1.
  static void derive(std::int32_t fraction, std::int32_t* derived) {
    constexpr std::int64_t half = std::int64_t{1} << 55U;
    derived[0] = static_cast<std::int32_t>(divide_nearest(half, fraction));
    derived[1] = static_cast<std::int32_t>(divide_nearest(half, (1 << 28) - fraction));
  }

  PhaseWarp(std::int32_t fraction, const std::int32_t* derived)
      : fraction_(static_cast<std::uint32_t>(fraction)), derived_(derived) {}

  [[nodiscard]] std::uint32_t angle_of(std::uint32_t phase) const {
    const std::uint32_t first = fraction_ << 4U;
    return phase < first ? scaled(phase, static_cast<std::uint32_t>(derived_[0]))
                         : half_turn + scaled(phase - first, static_cast<std::uint32_t>(derived_[1]));
  }

  [[nodiscard]] std::uint32_t phase_of(std::uint32_t angle) const {
    return angle < half_turn ? scaled(angle, 2 * fraction_)
                             : (fraction_ << 4U) + scaled(angle - half_turn, 2 * ((1U << 28U) - fraction_));
  }

 private:
  static constexpr std::uint32_t half_turn = 0x80000000U;

  /// Product of a phase and a factor in Q28.
  static std::uint32_t scaled(std::uint32_t phase, std::uint32_t factor) {
    return static_cast<std::uint32_t>((multiply_wide(phase, factor) + (1U << 27U)) >> 28U);
  }

  std::uint32_t fraction_;
  const std::int32_t* derived_;
};

}  // namespace proleg
