#pragma once

// From set-points to servo pulses, in integers: the last step, which simulator, emulated module and robot share.

#include <algorithm>
#include <cstdint>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

/// Unit of servo commands: a pulse width in twelfths of a microsecond, because the timer clocks of the STM32 divide
/// down to 12 MHz (84/7, 72/6, 48/4). One step is 0.0075 degrees.
inline constexpr std::int32_t servo_counts_per_us = 12;
/// Pulse width at 0 degrees: 1.5 ms.
inline constexpr std::int32_t servo_center = 1500 * servo_counts_per_us;
/// Change of the pulse width for +90 degrees: 1 ms.
inline constexpr std::int32_t servo_quarter_turn = 1000 * servo_counts_per_us;

/// Pulse width for a joint angle (90 degrees = 2^30), rounded to the nearest step, ties up. Angles beyond +-90 degrees
/// count as +-90.
[[nodiscard]] constexpr std::int32_t servo_command(std::int32_t angle) {
  constexpr std::int32_t right_angle = 1 << 30;
  return servo_center + multiply(std::clamp(angle, -right_angle, right_angle), servo_quarter_turn, 30);
}

/// Angle on the straight line from `from` to `to`. fraction: Q16, 0 at `from`, 65536 at `to`.
[[nodiscard]] constexpr std::int32_t interpolate(std::int32_t from, std::int32_t to, std::int32_t fraction) {
  const std::int64_t difference = std::int64_t{to} - from;
  return static_cast<std::int32_t>(from + shift_right_rounding(difference * fraction, 16));
}

/// Position between two ticks at which a servo samples the line: the middle of its interval, so that latency and
/// crystal error cannot move a sample across a tick. elapsed_us: time since the tick at the start of the interval.
/// tick_period_us: below 131072. Result: Q16, rounded down to an even number, at most 65536.
[[nodiscard]] constexpr std::int32_t sample_fraction(std::uint32_t elapsed_us, std::uint32_t servo_period_us,
                                                     std::uint32_t tick_period_us) {
  const std::uint32_t middle = elapsed_us + servo_period_us / 2;
  if (middle >= tick_period_us) {
    return 1 << 16;
  }
  return static_cast<std::int32_t>((middle << 15U) / tick_period_us << 1U);
}

}  // namespace proleg
