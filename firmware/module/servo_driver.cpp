#include "firmware/module/servo_driver.hpp"

namespace proleg::firmware {

void ServoDriver::reset() {
  mode_ = Mode::off;
  elapsed_us_ = ~0U;
  guard_.reset();
}

void ServoDriver::start_tick(Microseconds now, std::uint32_t tick, std::int32_t from, std::int32_t to) {
  if (is_moving() && has_pending_interval()) {
    skip_to(schedule_.tick_period_us() - 1U);
    take_interval(now);
  }
  from_ = from;
  to_ = to;
  sync_at_ = now;
  elapsed_us_ = schedule_.first_start_us(tick);
  poll(now);
}

void ServoDriver::follow() {
  if (mode_ == Mode::off) {
    mode_ = Mode::following;
  }
}

void ServoDriver::quick_stop(Microseconds now) {
  if (mode_ != Mode::following) {
    return;
  }
  if (!guard_.is_pulsing()) {
    stop();
    return;
  }
  mode_ = Mode::ramping;
  next_step_ = now + schedule_.servo_period_us();
}

void ServoDriver::stop() {
  if (mode_ != Mode::off) {
    mode_ = Mode::off;
    guard_.off();
  }
}

void ServoDriver::take_ramp_step(Microseconds now) {
  const std::int32_t step = MotionLimiter::step_of(min_command_speed, schedule_.servo_period_us());
  const std::int32_t safe_angle = guard_.safe_angle();
  guard_.command(now, std::clamp(safe_angle, guard_.angle() - step, guard_.angle() + step));
  next_step_ = guard_.angle() == safe_angle ? never : now + schedule_.servo_period_us();
}

}  // namespace proleg::firmware
