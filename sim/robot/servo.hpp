#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "shared/kernel/servo_command.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// The angle, in rad, that a servo turns to for a pulse width.
[[nodiscard]] inline double servo_target(std::int32_t command) {
  return static_cast<double>(command - servo_center) * (std::numbers::pi / 2.0 / servo_quarter_turn);
}

/// The speed, in rad/s, that a servo commands.
[[nodiscard]] inline double servo_speed(const ServoModel& servo, const Joint& joint, std::int32_t command,
                                        double angle) {
  return std::clamp(servo.gain * (servo_target(command) - angle), -joint.max_speed, joint.max_speed);
}

}  // namespace proleg::sim
