#include "firmware/module/servo_driver.hpp"

namespace proleg::firmware {

void ServoDriver::reset() {
  mode_ = Mode::off;
  pulsing_ = false;
  elapsed_us_ = ~0U;
  port_.off();
}

void ServoDriver::start_tick(Microseconds now, std::uint32_t tick, std::int32_t from, std::int32_t to) {
  if (mode_ == Mode::following && pulsing_ && has_pending_interval()) {
    skip_to(schedule_.tick_period_us() - 1U);
    take_interval();
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
  if (!pulsing_) {
    stop();
    return;
  }
  mode_ = Mode::ramping;
  next_step_ = now + schedule_.servo_period_us();
}

void ServoDriver::stop() {
  if (mode_ != Mode::off) {
    mode_ = Mode::off;
    pulsing_ = false;
    port_.off();
  }
}

void ServoDriver::take_ramp_step(Microseconds now) {
  constexpr std::uint32_t second_us = 1'000'000;
  const auto step =
      static_cast<std::int32_t>(std::uint64_t{quick_stop_speed} * schedule_.servo_period_us() / second_us);
  const std::int64_t way = std::int64_t{safe_angle} - angle_;
  if (way > step) {
    angle_ += step;
  } else if (way < -std::int64_t{step}) {
    angle_ -= step;
  } else {
    angle_ = safe_angle;
  }
  port_.pulse(servo_command(angle_), schedule_.servo_period_us());
  next_step_ = angle_ == safe_angle ? never : now + schedule_.servo_period_us();
}

}  // namespace proleg::firmware
