#pragma once

#include <cstdint>
#include <vector>

#include "shared/kernel/servo_command.hpp"
#include "shared/kernel/servo_schedule.hpp"
#include "sim/loop/kernel_chain.hpp"
#include "sim/robot/servo_pulse.hpp"

namespace proleg::sim {

/// Appends the pulses that the running joints of a chain give their servos in the last computed tick, in the order of
/// time, then of joints. They do not depend on the steps of the physics.
inline void append_servo_pulses(const KernelChain& chain, const ServoSchedule& schedule,
                                std::vector<ServoPulse>& pulses) {
  const std::uint64_t tick = chain.tick() - 1U;
  const std::uint64_t end = schedule.first_interval(tick + 1);
  for (std::uint64_t interval = schedule.first_interval(tick); interval < end; ++interval) {
    const std::int32_t fraction = schedule.fraction(interval);
    for (unsigned joint = 0; joint < chain.joint_count(); ++joint) {
      if (chain.is_running(joint)) {
        const Kernel& kernel = chain.kernel(joint);
        const std::int32_t angle = interpolate(kernel.previous_setpoint(joint), kernel.setpoint(joint), fraction);
        pulses.push_back({schedule.start_us(interval), joint, servo_command(angle)});
      }
    }
  }
}

}  // namespace proleg::sim
