#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "shared/kernel/servo_pulses.hpp"
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

/// A pulse that a servo takes at the start of one of its intervals.
struct ServoPulse {
  std::uint64_t time_us;  ///< since SYNC 0
  std::uint32_t joint;    ///< kernel order
  std::int32_t command;   ///< twelfths of a microsecond
};

/// The supply current of a servo, in mA. It is an estimate, since the physics has no currents. Figures are those of a
/// standard analogue RC servo at 6 V, from data sheets: 5 to 10 mA at rest, 150 to 250 mA running freely, 0.7 to 2.5 A
/// stalled. The stall current is below the modules' default limit of 2 A, so over-current in a simulation needs a lower
/// limit.
struct ServoCurrent {
  double idle_ma = 10.0;      ///< at rest, and without pulses
  double no_load_ma = 200.0;  ///< at full speed, without load
  double stall_ma = 1500.0;   ///< stalled, at full voltage
};

/// The current at an actual speed, for a commanded one. The electronics apply a voltage in proportion to the commanded
/// speed; the part of it that exceeds the back-EMF, which is in proportion to the actual speed, drives current through
/// the winding and so gives torque. The motor's friction adds up to no_load_ma. commanded, actual: rad/s; max_speed:
/// rad/s, above 0.
[[nodiscard]] inline double servo_current_ma(const ServoCurrent& servo, double commanded, double actual,
                                             double max_speed) {
  const double voltage_left = std::min(std::abs(commanded - actual) / max_speed, 1.0);
  const double speed = std::min(std::abs(actual) / max_speed, 1.0);
  return std::min(
      servo.idle_ma + (servo.no_load_ma - servo.idle_ma) * speed + (servo.stall_ma - servo.idle_ma) * voltage_left,
      servo.stall_ma);
}

}  // namespace proleg::sim
