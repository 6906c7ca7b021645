#pragma once

#include <algorithm>

#include "firmware/module/ports.hpp"
#include "shared/kernel/motion_limiter.hpp"

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

}  // namespace proleg::firmware
