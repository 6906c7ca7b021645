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

void ServoDriver::ramp_in(Microseconds now, std::int32_t from, std::int32_t to, std::uint32_t speed) {
  const bool begins = mode_ == Mode::off;
  if (begins) {
    mode_ = Mode::ramping_in;
    guard_.command(now, from);
  }
  if (is_ramping_in() && (begins || to != goal_)) {
    begin_ramp(now, to, speed);
  }
}

void ServoDriver::follow() {
  if (mode_ == Mode::off || mode_ == Mode::ramping_in) {
    mode_ = Mode::following;
  }
}

void ServoDriver::begin_ramp(Microseconds now, std::int32_t goal, std::uint32_t speed) {
  goal_ = goal;
  step_ = MotionLimiter::step_of(speed, schedule_.servo_period_us());
  next_step_ = now + schedule_.servo_period_us();
}

void ServoDriver::quick_stop(Microseconds now) {
  if (mode_ != Mode::following && mode_ != Mode::ramping_in) {
    return;
  }
  if (!guard_.is_pulsing()) {
    stop();
    return;
  }
  mode_ = Mode::stopping;
  begin_ramp(now, guard_.safe_angle(), min_command_speed);
}

void ServoDriver::stop() {
  if (mode_ != Mode::off) {
    mode_ = Mode::off;
    guard_.off();
  }
}

void ServoDriver::take_ramp_step(Microseconds now) {
  const std::int64_t angle = guard_.angle();
  guard_.command(now, static_cast<std::int32_t>(std::clamp<std::int64_t>(goal_, angle - step_, angle + step_)));
  next_step_ = guard_.angle() == goal_ ? never : now + schedule_.servo_period_us();
}

}  // namespace proleg::firmware
