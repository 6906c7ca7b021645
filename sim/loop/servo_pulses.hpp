#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/kernel/motion_limiter.hpp"
#include "shared/kernel/servo_command.hpp"
#include "shared/kernel/servo_schedule.hpp"
#include "sim/loop/kernel_chain.hpp"
#include "sim/robot/servo_pulse.hpp"

namespace proleg::sim {

/// Makes the pulses that a chain gives its servos, as the modules of the robot do. They do not depend on the steps of
/// the physics.
class ServoPulses {
 public:
  /// limits: of each joint. command_speed: the greatest, in degrees a second.
  ServoPulses(const ServoSchedule& schedule, std::span<const AngleLimits> limits, std::uint32_t command_speed)
      : schedule_(schedule), limiters_(limits.size()) {
    const std::int32_t step = MotionLimiter::step_of(command_speed, schedule.servo_period_us());
    for (std::size_t joint = 0; joint < limits.size(); ++joint) {
      limiters_[joint].set_limits(limits[joint].lower, limits[joint].upper);
      limiters_[joint].set_step(step);
    }
  }

  [[nodiscard]] const ServoSchedule& schedule() const { return schedule_; }

  /// Appends the pulses of the running joints in the last computed tick, in the order of time, then of joints. To be
  /// called once after each tick.
  void append(const KernelChain& chain, std::vector<ServoPulse>& pulses) {
    ways_.clear();
    for (unsigned joint = 0; joint < chain.joint_count(); ++joint) {
      if (chain.is_running(joint)) {
        ways_.push_back({joint, chain.kernel(joint).previous_setpoint(joint), chain.kernel(joint).setpoint(joint)});
      } else {
        limiters_[joint].release();
      }
    }
    const std::uint64_t tick = chain.tick() - 1U;
    const std::uint64_t end = schedule_.first_interval(tick + 1);
    for (std::uint64_t interval = schedule_.first_interval(tick); interval < end; ++interval) {
      const std::int32_t fraction = schedule_.fraction(interval);
      for (const Way& way : ways_) {
        const std::int32_t angle = interpolate(way.from, way.to, fraction);
        pulses.push_back({schedule_.start_us(interval), way.joint, servo_command(limiters_[way.joint].next(angle))});
      }
    }
  }

 private:
  /// Of a running joint, in the tick.
  struct Way {
    unsigned joint;
    std::int32_t from;
    std::int32_t to;
  };

  ServoSchedule schedule_;
  std::vector<MotionLimiter> limiters_;  ///< by joint
  std::vector<Way> ways_;                ///< in append()
};

}  // namespace proleg::sim
