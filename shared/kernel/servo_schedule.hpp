#pragma once

#include <cstdint>

#include "shared/kernel/servo_command.hpp"

namespace proleg {

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

}  // namespace proleg
