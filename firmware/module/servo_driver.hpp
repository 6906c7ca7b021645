#pragma once

#include "firmware/module/servo_guard.hpp"
#include "shared/kernel/servo_schedule.hpp"

namespace proleg::firmware {

/// Gives the servo its pulses, interval by interval, along the line between two set-points. Before the first line they
/// follow a ramp to its start. In a quick stop they follow a ramp to the safe pose: 0 degrees, or the limit that is
/// nearest to it.
class ServoDriver {
 public:
  explicit ServoDriver(ServoPort& port) : guard_(port) {}

  /// Returns to the state after reset: no pulses, and no line to follow.
  void reset();
  void configure(const ServoSchedule& schedule) {
    schedule_ = schedule;
    guard_.set_period(schedule.servo_period_us());
  }
  [[nodiscard]] ServoGuard& guard() { return guard_; }
  [[nodiscard]] const ServoGuard& guard() const { return guard_; }

  /// Must be called when SYNC `tick` came at `now`. Until the next SYNC the set-point moves from `from` to `to` (90
  /// degrees = 2^30). If SYNC was early and an interval of the tick before is pending, its pulse is given now.
  void start_tick(Microseconds now, std::uint32_t tick, std::int32_t from, std::int32_t to);

  /// Ramps from one angle to another one, both within the limits, and holds that. It does so only before the first
  /// line, if the servo has no pulses yet. speed: degrees a second, at most the greatest one. While it ramps, `to` may
  /// change.
  void ramp_in(Microseconds now, std::int32_t from, std::int32_t to, std::uint32_t speed);
  /// Whether ramp_in() was called, and the servo has not followed a line or stopped since.
  [[nodiscard]] bool is_ramping_in() const { return mode_ == Mode::ramping_in; }
  /// Whether the servo has ramped in, and holds the angle.
  [[nodiscard]] bool has_ramped_in() const { return is_ramping_in() && next_step_ == never; }
  /// Follows the line, from its next interval on.
  void follow();
  /// Whether the servo follows the line and has given a pulse.
  [[nodiscard]] bool is_moving() const { return mode_ == Mode::following && guard_.is_pulsing(); }
  /// Ramps from the last pulse to the safe pose at 90 degrees a second, then holds. A servo without a pulse so far
  /// stays off: its angle is not known.
  void quick_stop(Microseconds now);
  /// Stops the pulses.
  void stop();

  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  enum class Mode : std::uint8_t { off, ramping_in, following, stopping };

  /// Begins a ramp in either direction; its first step is a period from now.
  void begin_ramp(Microseconds now, std::int32_t goal, std::uint32_t speed);
  [[nodiscard]] bool is_ramping() const { return mode_ == Mode::stopping || mode_ == Mode::ramping_in; }

  [[nodiscard]] bool has_pending_interval() const { return elapsed_us_ < schedule_.tick_period_us(); }
  /// Skips intervals: if several have started, only the latest gets a pulse.
  void skip_to(Microseconds since_sync_us);
  void take_interval(Microseconds now);
  void take_ramp_step(Microseconds now);

  ServoGuard guard_;
  ServoSchedule schedule_{20'000, 10'000};
  Mode mode_ = Mode::off;
  std::int32_t from_ = 0;
  std::int32_t to_ = 0;
  /// Time from SYNC to the next interval; a tick period or more: no interval is pending.
  std::uint32_t elapsed_us_ = ~0U;
  Microseconds sync_at_ = 0;
  Microseconds next_step_ = never;  ///< time of the ramp's next step; never: the ramp has ended
  std::int32_t goal_ = 0;           ///< end of the ramp
  std::int32_t step_ = 0;           ///< change of the angle in a servo period of the ramp
};

// poll() runs up to a thousand times a second; it is in the header so that the compiler can inline it.

inline void ServoDriver::poll(Microseconds now) {
  if (is_ramping()) {
    if (now >= next_step_) {
      take_ramp_step(now);
    }
  } else if (has_pending_interval() && now >= sync_at_ + elapsed_us_) {
    skip_to(now - sync_at_);
    take_interval(now);
  }
}

inline void ServoDriver::skip_to(Microseconds since_sync_us) {
  const std::uint32_t last_us = schedule_.tick_period_us() - 1U;
  const std::uint32_t until_us = since_sync_us < last_us ? static_cast<std::uint32_t>(since_sync_us) : last_us;
  if (until_us > elapsed_us_) {
    elapsed_us_ += (until_us - elapsed_us_) / schedule_.servo_period_us() * schedule_.servo_period_us();
  }
}

inline void ServoDriver::take_interval(Microseconds now) {
  if (mode_ == Mode::following) {
    guard_.command(now, interpolate(from_, to_, schedule_.fraction_at(elapsed_us_)));
  }
  elapsed_us_ += schedule_.servo_period_us();
}

inline Microseconds ServoDriver::next_deadline() const {
  if (is_ramping()) {
    return next_step_;
  }
  return has_pending_interval() ? sync_at_ + elapsed_us_ : never;
}

}  // namespace proleg::firmware
