#pragma once

#include <algorithm>
#include <cmath>

namespace proleg::sim {

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
