#include "firmware/module/drive.hpp"

#include <algorithm>

namespace proleg::firmware {

using canopen::PowerState;

void Drive::reset() {
  servo_.reset();
  power_.reset();
  mode_ = canopen::mode_gait;
  followed_gait_ = true;
  target_ = 0;
  ramp_in_speed_ = 0;
  setpoint_ = 0;
}

void Drive::set_mode(std::int8_t mode) {
  if (mode == canopen::mode_direct_position && mode_ != mode) {
    target_ = setpoint_;
  }
  mode_ = mode;
}

std::uint16_t Drive::statusword() const {
  const std::uint16_t word = power_.statusword();
  return servo_.has_ramped_in() ? static_cast<std::uint16_t>(word | canopen::target_reached) : word;
}

std::int32_t Drive::wanted_setpoint(const Kernel& kernel, const AngleLimits& limits) const {
  return mode_ == canopen::mode_gait ? kernel.setpoint(kernel.first_joint())
                                     : std::clamp(target_, limits.lower, limits.upper);
}

void Drive::start_tick(Microseconds now, std::uint32_t tick, const Kernel& kernel, const AngleLimits& limits) {
  const unsigned joint = kernel.first_joint();
  const bool gait = mode_ == canopen::mode_gait;
  // Between two ticks of the gait the servo follows the kernel's line, which the simulator computes, too.
  const std::int32_t from = gait && followed_gait_ ? kernel.previous_setpoint(joint) : setpoint_;
  setpoint_ = wanted_setpoint(kernel, limits);
  followed_gait_ = gait;
  servo_.guard().set_limits(limits.lower, limits.upper);
  servo_.start_tick(now, tick, from, setpoint_);
}

void Drive::ramp_in(Microseconds now, const StartPose& start) {
  if (!servo_.is_ramping_in() && !start.measured) {
    return;
  }
  setpoint_ = wanted_setpoint(start.kernel, start.limits);
  servo_.guard().set_limits(start.limits.lower, start.limits.upper);
  servo_.ramp_in(now, start.measured.value_or(setpoint_), setpoint_, ramp_in_speed_);
}

void Drive::update(Microseconds now, bool operational, bool synchronised, const StartPose* start) {
  const bool may_ramp_in = operational && start != nullptr && ramp_in_speed_ != 0;
  if (!synchronised && (servo_.is_moving() || (servo_.is_ramping_in() && !may_ramp_in))) {
    power_.quick_stop();
  }
  const PowerState state = power_.state();
  const bool is_enabled = state == PowerState::operation_enabled;
  const bool needs_supply = is_enabled || state == PowerState::switched_on || state == PowerState::quick_stop_active;
  if (needs_supply) {
    switch_supply(true);
  }
  if (operational && synchronised && is_enabled) {
    servo_.follow();
  } else if (may_ramp_in && !synchronised && is_enabled) {
    ramp_in(now, *start);
  } else if (operational && state == PowerState::quick_stop_active) {
    servo_.quick_stop(now);
  } else {
    servo_.stop();
  }
  if (!needs_supply) {
    switch_supply(false);
  }
}

void Drive::switch_supply(bool is_on) {
  if (is_on != has_supply_) {
    has_supply_ = is_on;
    port_.switch_supply(is_on);
  }
}

}  // namespace proleg::firmware
