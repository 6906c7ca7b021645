#pragma once

// The pulses of the servo: the guard through which all of them pass, and the driver that decides their angles.

#include <algorithm>

#include "firmware/module/ports.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::firmware {

/// The one place that gives the servo its pulses; all angles that are computed pass through it. Whatever is received,
/// set or lost, each angle is within the joint's limits, and successive angles move no faster than the greatest
/// commanded speed. Only the first angle after the servo had no pulses may be anywhere within the limits.
class ServoGuard {
 public:
  explicit ServoGuard(ServoPort& port) : port_(port) { set_command_speed(default_command_speed); }

  /// Returns to the state after reset: no pulses, default limits and speed.
  void reset() {
    limiter_ = {};
    set_command_speed(default_command_speed);
    port_.off();
  }
  void set_limits(std::int32_t lower, std::int32_t upper) { limiter_.set_limits(lower, upper); }
  void set_period(std::uint32_t servo_period_us) {
    period_us_ = servo_period_us;
    set_command_speed(command_speed_);
  }
  /// The greatest speed [deg/s].
  [[nodiscard]] std::uint32_t command_speed() const { return command_speed_; }
  void set_command_speed(std::uint32_t speed) {
    command_speed_ = speed;
    limiter_.set_step(MotionLimiter::step_of(speed, period_us_));
    const std::int64_t per_us = limiter_.step() / static_cast<std::int32_t>(period_us_) + 1;
    credit_per_us_ = per_us + per_us / 64 + 1;
  }

  /// Gives a pulse for the allowed angle that is nearest to the wanted one.
  void command(Microseconds now, std::int32_t wanted) {
    const std::int64_t before = is_pulsing() ? limiter_.angle() : limiter_.within_limits(wanted);
    const std::int64_t credit = credit_at(now);
    const std::int64_t angle = limiter_.next(wanted, static_cast<std::int32_t>(credit));
    credit_ = credit - (angle < before ? before - angle : angle - before);
    last_pulse_ = now;
    port_.pulse(servo_command(limiter_.angle()), period_us_);
  }
  /// Stops the pulses.
  void off() {
    limiter_.release();
    port_.off();
  }

  [[nodiscard]] bool is_pulsing() const { return !limiter_.is_released(); }
  /// The angle of the last pulse.
  [[nodiscard]] std::int32_t angle() const { return limiter_.angle(); }
  /// The allowed angle that is nearest to 0.
  [[nodiscard]] std::int32_t safe_angle() const { return limiter_.within_limits(0); }

 private:
  /// How far this pulse may be from the one before. If SYNCs come more often than their period, pulses do, too, and
  /// would add up to a higher speed. So each microsecond gives a credit of what the greatest speed allows, and 1/64
  /// more, as the module's clock may be slow. The credit is at most two and a half steps, for a SYNC that is early
  /// by half a period: then a pulse of the tick before comes just before the next one.
  [[nodiscard]] std::int64_t credit_at(Microseconds now) const {
    const std::int64_t step = limiter_.step();
    const std::int64_t max_credit = std::min<std::int64_t>(5 * step / 2, 0x7FFF'FFFF);
    if (!is_pulsing()) {
      return max_credit;
    }
    const std::int64_t passed_us = static_cast<std::int64_t>(std::min(now - last_pulse_, Microseconds{3} * period_us_));
    return std::min(credit_ + passed_us * credit_per_us_, max_credit);
  }

  ServoPort& port_;
  MotionLimiter limiter_;
  std::uint32_t period_us_ = 20'000;
  std::uint32_t command_speed_ = default_command_speed;
  std::int64_t credit_per_us_ = 0;
  Microseconds last_pulse_ = 0;
  std::int64_t credit_ = 0;  ///< the credit after the last pulse
};

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
