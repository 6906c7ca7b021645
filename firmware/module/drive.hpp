#pragma once

#include <optional>

#include "firmware/module/servo_driver.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/kernel/kernel.hpp"
#include "shared/kernel/kernel_configuration.hpp"

namespace proleg::firmware {

/// The servo as a drive of CiA 402. The drive decides whether the servo has power, and which set-point it follows. The
/// kernel computes the gait's set-point in every state of the drive.
class Drive {
 public:
  explicit Drive(ServoPort& port) : port_(port), servo_(port) {}

  void reset();
  void configure(const ServoSchedule& schedule) { servo_.configure(schedule); }

  /// Object 0x6080: the greatest speed of commanded angles [deg/s].
  [[nodiscard]] std::uint32_t command_speed() const { return servo_.guard().command_speed(); }
  void set_command_speed(std::uint32_t speed) { servo_.guard().set_command_speed(speed); }

  /// Must be called when Operational is left: the pulses are off until the host enables the servo again.
  void disable() { power_.disable_voltage(); }

  [[nodiscard]] canopen::PowerControl& power() { return power_; }
  [[nodiscard]] const canopen::PowerControl& power() const { return power_; }

  /// Object 0x6060: the mode, canopen::mode_gait or mode_direct_position.
  [[nodiscard]] std::int8_t mode() const { return mode_; }
  /// Sets the mode. Direct position begins at the present set-point of the servo: an earlier target has no effect.
  void set_mode(std::int8_t mode);
  /// Object 0x607A: the set-point of direct position, 90 degrees = 2^30. It takes effect at SYNC, within the joint's
  /// limits.
  [[nodiscard]] std::int32_t target() const { return target_; }
  void set_target(std::int32_t target) { target_ = target; }

  /// Object 0x6062: the set-point that the servo approaches in this tick, 90 degrees = 2^30.
  [[nodiscard]] std::int32_t setpoint() const { return setpoint_; }

  /// Object 0x200E: speed at which the joint moves to the start of a gait [deg/s]; 0: it does not ramp in. The greatest
  /// speed limits it, too.
  [[nodiscard]] std::uint32_t ramp_in_speed() const { return ramp_in_speed_; }
  void set_ramp_in_speed(std::uint32_t speed) { ramp_in_speed_ = speed; }
  /// Object 0x6041: the statusword.
  [[nodiscard]] std::uint16_t statusword() const;
  /// Whether the servo has pulses without a tick: it moves to the start of the gait, or has arrived there.
  [[nodiscard]] bool is_ramping_in() const { return servo_.is_ramping_in(); }

  /// Must be called at SYNC `tick`, after the kernel has computed it.
  void start_tick(Microseconds now, std::uint32_t tick, const Kernel& kernel, const AngleLimits& limits);

  /// The inputs of a joint that ramps in.
  struct StartPose {
    std::optional<std::int32_t> measured;  ///< measured angle; nothing if there is no new reading
    const Kernel& kernel;                  ///< the kernel, in state 0
    AngleLimits limits;
  };
  /// Must be called after each event: switches the servo's pulses on or off, and its supply, which it has from Switched
  /// on to the end of Quick stop active (CiA 402-2, states in which the power is applied). operational: NMT state;
  /// synchronised: whether the set-point is that of the robot's tick; start: null unless the robot waits for SYNC 0. A
  /// servo that moves and is no longer synchronised makes a quick stop, which only the host ends.
  void update(Microseconds now, bool operational, bool synchronised, const StartPose* start = nullptr);

  void poll(Microseconds now) { servo_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const { return servo_.next_deadline(); }

 private:
  [[nodiscard]] std::int32_t wanted_setpoint(const Kernel& kernel, const AngleLimits& limits) const;
  void ramp_in(Microseconds now, const StartPose& start);
  void switch_supply(bool is_on);

  ServoPort& port_;
  ServoDriver servo_;
  canopen::PowerControl power_;
  std::int8_t mode_ = canopen::mode_gait;
  bool followed_gait_ = true;  ///< whether the last tick was one of the gait
  std::int32_t target_ = 0;
  std::uint32_t ramp_in_speed_ = 0;
  std::int32_t setpoint_ = 0;  ///< the set-point that the servo approaches, in either mode
  bool has_supply_ = false;
};

}  // namespace proleg::firmware
