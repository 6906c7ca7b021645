#pragma once

#include "firmware/module/tick_record.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/robot_configuration.hpp"
#include "shared/gait/joint_readings.hpp"
#include "shared/kernel/kernel_configuration.hpp"

namespace proleg::firmware {

/// The configuration of the robot as the host has written it. It takes effect at `activate`.
struct ModuleSettings {
  std::uint8_t joint = 0;
  std::uint8_t joint_count = canopen::object::joint_count.default_value;
  std::uint8_t front_node = 0;
  std::uint8_t rear_node = 0;
  std::uint16_t robot_id = canopen::object::robot_id.default_value;
  std::uint32_t tick_period_us = canopen::object::tick_period.default_value;
  std::uint32_t servo_period_us = canopen::object::servo_period.default_value;
  std::uint64_t seed = canopen::object::seed_low.default_value;
  std::array<std::uint8_t, max_slots> algorithms{};  ///< ids of algorithms; 0: the slot is empty
  std::array<std::uint64_t, max_slots> groups{};     ///< bit j: joint j
  /// For each channel and joint, the node that sends the joint's state frames; 0: none.
  std::array<std::array<std::uint8_t, max_joints>, max_channels> nodes{};

  [[nodiscard]] KernelConfiguration kernel() const;
  /// The CRC that all modules of the robot compute (canopen::configuration_crc).
  [[nodiscard]] std::uint32_t crc(std::uint8_t own_node) const;
};

/// The kernel of the module's one joint, with the state that belongs to it: whether it is configured, the configuration
/// of the robot, the joint's limits and contacts.
class JointKernel {
 public:
  /// Configures the joint. A status other than ok leaves it unconfigured.
  Status activate(const ModuleSettings& settings, std::uint8_t node);
  void deactivate();
  /// Whether the joint is configured.
  [[nodiscard]] bool active() const { return active_; }
  /// Limits of the joint, +-90 degrees until they are set.
  [[nodiscard]] const AngleLimits& limits() const { return limits_; }

  /// The last status with which the kernel has rejected a request (object 0x2001:8); ok: it has rejected none.
  [[nodiscard]] Status last_refusal() const { return last_refusal_; }
  void keep_refusal(Status status) { last_refusal_ = status; }
  void clear_refusal() { last_refusal_ = Status::ok; }

  // The functions below may be called only if active().
  [[nodiscard]] unsigned joint() const { return kernel_.first_joint(); }
  [[nodiscard]] std::uint16_t robot_id() const { return robot_id_; }
  [[nodiscard]] std::uint32_t configuration_crc() const { return crc_; }
  /// Number of SYNCs from one monitoring frame to the next.
  [[nodiscard]] std::uint32_t monitoring_period() const { return monitoring_period_; }
  /// The algorithm of a slot that drives the joint; null if the slot does not.
  [[nodiscard]] const ActuationModule* algorithm(unsigned slot) const;
  /// Whether a slot drives the joint with the algorithm of this id.
  [[nodiscard]] bool has_algorithm(unsigned slot, std::uint8_t id) const;

  // Settings before the start: state 0 follows from limits and parameters at restart().
  Status set_limits(const AngleLimits& limits);
  Status set_parameter(unsigned slot, unsigned number, std::int32_t value);
  /// Returns to state 0. Staged values stay.
  void restart();

  Status open(std::uint16_t transaction);
  [[nodiscard]] bool has_open_transaction() const { return active_ && kernel_.has_open_transaction(); }
  /// Stages a value in the open transaction.
  Status stage(unsigned slot, unsigned number, bool internal, std::int32_t value);
  /// The staged value of a parameter; the value in force if none is staged.
  [[nodiscard]] std::int32_t staged_parameter(unsigned slot, unsigned number) const;
  Status commit(std::uint16_t transaction, std::uint32_t tick);

  /// Joins a robot that already moves, see Kernel::join().
  void join(std::uint32_t tick);
  /// Computes a tick, after `missed` ones whose SYNC was not received; those have the contacts of the last tick before.
  /// sensors: touch sensors as they are at SYNC. current_ma: current of the servo, as it was read after the SYNC
  /// before.
  void advance(unsigned missed, std::uint8_t sensors, std::uint16_t current_ma);
  /// Sets the flag `fault` of the state frames from the next one on.
  void set_fault(bool fault) { fault_ = fault; }
  /// Takes a state frame of another joint.
  void receive(unsigned joint, unsigned channel, const StateFrame& frame) { kernel_.receive(joint, channel, frame); }

  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  /// Record of the last advance(); its tick is `none` after deactivate(), restart() or join().
  [[nodiscard]] const TickRecord& record() const { return record_; }
  /// Checksum of the set-points since restart(); not complete after join().
  [[nodiscard]] SetpointChecksum& checksum() { return checksum_; }
  [[nodiscard]] const SetpointChecksum& checksum() const { return checksum_; }

 private:
  static constexpr AngleLimits full_range{-quarter_turn, quarter_turn};

  void set_flags(unsigned flags);
  void compute_tick();
  void write_record();

  KernelOf<1> kernel_;
  TickRecord record_;
  SetpointChecksum checksum_;
  ContactDebouncer debouncer_;
  bool active_ = false;
  Status last_refusal_ = Status::ok;
  bool fault_ = false;
  std::uint16_t robot_id_ = 0;
  std::uint32_t crc_ = 0;
  std::uint32_t monitoring_period_ = 0;
  AngleLimits limits_ = full_range;
};

}  // namespace proleg::firmware
