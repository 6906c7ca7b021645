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
  setpoint_ = 0;
}

void Drive::set_mode(std::int8_t mode) {
  if (mode == canopen::mode_direct_position && mode_ != mode) {
    target_ = setpoint_;
  }
  mode_ = mode;
}

void Drive::start_tick(Microseconds now, std::uint32_t tick, const Kernel& kernel, const canopen::AngleLimits& limits) {
  const unsigned joint = kernel.first_joint();
  const bool gait = mode_ == canopen::mode_gait;
  // Between two ticks of the gait the line is the kernel's own, which the simulator computes too.
  const std::int32_t from = gait && followed_gait_ ? kernel.previous_setpoint(joint) : setpoint_;
  if (gait) {
    setpoint_ = kernel.setpoint(joint);
  } else {
    setpoint_ = std::clamp(target_, limits.lower, limits.upper);
  }
  followed_gait_ = gait;
  servo_.guard().set_limits(limits.lower, limits.upper);
  servo_.start_tick(now, tick, from, setpoint_);
}

void Drive::update(Microseconds now, bool operational, bool synchronised) {
  if (!synchronised && servo_.is_moving()) {
    power_.quick_stop();
  }
  if (operational && synchronised && power_.state() == PowerState::operation_enabled) {
    servo_.follow();
  } else if (operational && power_.state() == PowerState::quick_stop_active) {
    servo_.quick_stop(now);
  } else {
    servo_.stop();
  }
}

}  // namespace proleg::firmware
