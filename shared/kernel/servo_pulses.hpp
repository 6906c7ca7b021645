#pragma once

// From set-points to servo pulses, in integers, as simulator, emulated module and robot share it: the width of a pulse,
// when servos receive pulses, and the limits of angle and speed.

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

/// When servos receive pulses. Interval n starts n periods after SYNC 0, independently of the ticks. Its pulse is the
/// point in the middle of the interval on the line between the two set-points of the tick in which it starts. All of
/// this is integers and independent of the step of a physics engine, so simulator and module compute the same pulses.
class ServoSchedule {
 public:
  /// Takes both periods in us, above 0; tick_period_us is below 131072.
  constexpr ServoSchedule(std::uint32_t servo_period_us, std::uint32_t tick_period_us)
      : servo_period_us_(servo_period_us), tick_period_us_(tick_period_us) {}

  [[nodiscard]] constexpr std::uint32_t servo_period_us() const { return servo_period_us_; }
  [[nodiscard]] constexpr std::uint32_t tick_period_us() const { return tick_period_us_; }

  /// Number of the first interval that starts at SYNC `tick` or later. The intervals of tick k are those from
  /// first_interval(k) up to, but without, first_interval(k + 1); there may be none.
  [[nodiscard]] constexpr std::uint64_t first_interval(std::uint64_t tick) const {
    return (tick * tick_period_us_ + servo_period_us_ - 1) / servo_period_us_;
  }
  /// Time from SYNC 0 to the start of an interval [us].
  [[nodiscard]] constexpr std::uint64_t start_us(std::uint64_t interval) const { return interval * servo_period_us_; }
  /// Time from SYNC `tick` to the start of the first interval that starts then or later [us]: 0 to servo_period_us() -
  /// 1.
  [[nodiscard]] constexpr std::uint32_t first_start_us(std::uint64_t tick) const {
    return static_cast<std::uint32_t>(start_us(first_interval(tick)) - tick * tick_period_us_);
  }

  /// Position at which the interval samples the line: Q16, 0 at out(k), 65536 at out(k + 1), where k is the tick in
  /// which the interval starts.
  [[nodiscard]] constexpr std::int32_t fraction(std::uint64_t interval) const {
    return fraction_at(static_cast<std::uint32_t>(start_us(interval) % tick_period_us_));
  }
  /// Position at which an interval that starts `elapsed_us` after the SYNC of its tick samples the line: Q16, as above
  /// 0 to 65536.
  [[nodiscard]] constexpr std::int32_t fraction_at(std::uint32_t elapsed_us) const {
    return sample_fraction(elapsed_us, servo_period_us_, tick_period_us_);
  }

 private:
  std::uint32_t servo_period_us_;
  std::uint32_t tick_period_us_;
};

/// The default for the greatest speed of commanded angles (object 0x6080) [deg/s]. It is faster than the servos that
/// such modules use (60 degrees in 0.083 s). A quick stop uses the minimum.
inline constexpr std::uint32_t default_command_speed = 720;
inline constexpr std::uint32_t min_command_speed = 90;
inline constexpr std::uint32_t max_command_speed = 10'000;

/// The last step before the pulse. The angle that a servo is commanded to is within the joint's limits. It differs from
/// the angle of the pulse before by at most what the greatest speed allows in a servo period. All commanded angles pass
/// through here, whether a gait, a host or a fault of either computes them. Simulator and module use this class.
class MotionLimiter {
 public:
  /// Greatest change of the angle in a servo period, 90 degrees = 2^30, rounded down. degrees_per_second: at most
  /// max_command_speed; servo_period_us: below 2^17.
  [[nodiscard]] static constexpr std::int32_t step_of(std::uint32_t degrees_per_second, std::uint32_t servo_period_us) {
    const std::uint64_t step = (std::uint64_t{degrees_per_second} * servo_period_us << 30U) / 90'000'000U;
    return static_cast<std::int32_t>(std::min<std::uint64_t>(step, 0x7FFF'FFFF));
  }

  /// Sets the limits of the joint angle, lower <= upper. The next angle is cut to them even if the last one was not.
  constexpr void set_limits(std::int32_t lower, std::int32_t upper) {
    lower_ = lower;
    upper_ = upper;
  }
  constexpr void set_step(std::int32_t max_step) { max_step_ = max_step; }
  [[nodiscard]] constexpr std::int32_t step() const { return max_step_; }

  /// Notes that the servo gets no pulses. Its position is then unknown, so the first angle afterwards may be any within
  /// the limits.
  constexpr void release() { is_released_ = true; }

  /// The angle to command when `wanted` is wanted. max_way: greatest distance from the last angle, if that is less than
  /// the step.
  constexpr std::int32_t next(std::int32_t wanted, std::int32_t max_way = 0x7FFF'FFFF) {
    const std::int32_t bound = std::min(max_step_, max_way);
    const std::int32_t goal = within_limits(wanted);
    if (is_released_) {
      is_released_ = false;
      angle_ = goal;
    } else {
      const std::int64_t way = std::int64_t{goal} - angle_;
      angle_ += static_cast<std::int32_t>(std::clamp<std::int64_t>(way, -bound, bound));
    }
    return angle_;
  }

  /// The angle within the limits that is nearest to the wanted one.
  [[nodiscard]] constexpr std::int32_t within_limits(std::int32_t wanted) const {
    return std::clamp(wanted, lower_, upper_);
  }

  /// The angle that the last next() returned.
  [[nodiscard]] constexpr std::int32_t angle() const { return angle_; }
  [[nodiscard]] constexpr bool is_released() const { return is_released_; }

 private:
  static constexpr std::int32_t right_angle = 1 << 30;

  std::int32_t lower_ = -right_angle;
  std::int32_t upper_ = right_angle;
  std::int32_t max_step_ = step_of(default_command_speed, 20'000);
  std::int32_t angle_ = 0;
  bool is_released_ = true;
};

}  // namespace proleg
