#pragma once

#include <algorithm>
#include <cmath>

namespace proleg::sim {

/// What a servo draws of its supply, in mA: an estimate, so that what reads it has something to read; the physics knows
/// no currents. Figures of a standard analogue RC servo at 6 V, as makers' data sheets have them: 5 to 10 mA at rest,
/// 150 to 250 mA running freely, 0.7 to 2.5 A stalled. A stalled one stays below the modules' default limit of 2 A, so
/// that over-current in a simulation is a matter of a lower limit.
struct ServoCurrent {
  double idle_ma = 10.0;      ///< at rest, and without pulses
  double no_load_ma = 200.0;  ///< at full speed, nothing held against it
  double stall_ma = 1500.0;   ///< held, with all its voltage
};

/// The current at a speed, when another is asked of the motor. The electronics give a motor voltage by the speed that
/// they ask for; what of it is not taken up by the speed that it has (its back-EMF) drives current through its winding,
/// and with it torque. Its own friction adds up to no_load_ma. commanded, actual: rad/s; max_speed: rad/s, above 0.
[[nodiscard]] inline double servo_current_ma(const ServoCurrent& servo, double commanded, double actual,
                                             double max_speed) {
  const double voltage_left = std::min(std::abs(commanded - actual) / max_speed, 1.0);
  const double speed = std::min(std::abs(actual) / max_speed, 1.0);
  return std::min(
      servo.idle_ma + (servo.no_load_ma - servo.idle_ma) * speed + (servo.stall_ma - servo.idle_ma) * voltage_left,
      servo.stall_ma);
}

}  // namespace proleg::sim
