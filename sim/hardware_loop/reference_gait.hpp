#pragma once

// The gait in memory, and what the modules made of a tick, which is compared with it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/hardware_loop/hardware_report.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/hardware_loop/plant_ticks.hpp"
#include "sim/loop/gait.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The gait in memory that the modules are compared with. It gets the same changes, losses and touch sensors, and its
/// joints stop and join when their modules do.
class ReferenceGait {
 public:
  /// scenario, losses: must outlive this. losses: null for none.
  ReferenceGait(const Scenario& scenario, const Losses* losses);

  /// What the module of a joint did in a tick.
  struct ModuleTick {
    bool has_computed;   ///< its record holds the tick
    bool has_sent;       ///< it sent its state frame after the tick's SYNC
    bool has_restarted;  ///< the run restarted it at the tick's SYNC
  };
  /// Called for each joint before advance(): stops it or lets it join, as its module did. Reports failures of the
  /// module.
  void follow(unsigned joint, const ModuleTick& module, HardwareReport& report);
  /// Position in the scenario of the change for the coming tick, if there is one.
  [[nodiscard]] std::optional<std::size_t> due_change() const { return gait_.due_change(); }
  /// Called before advance(): the current that the module of a joint read for the tick, in mA.
  void set_current(unsigned joint, std::uint16_t current_ma);
  /// Computes the tick. link_contacts: as they were at its SYNC. is_change_made: the modules have the due change; if
  /// not, it never takes effect. Returns the change that took effect, if any.
  const Change* advance(std::span<const std::uint8_t> link_contacts, bool is_change_made);

  // After advance(), about the tick that it computed.
  /// Reports what differs. pulses: in the order of time, then of joints, without those of failed modules.
  void compare(std::span<const std::int32_t> setpoints, std::span<const ServoPulse> pulses, HardwareReport& report);
  /// The module of this joint failed and has not joined again.
  [[nodiscard]] bool has_failed(unsigned joint) const { return failed_[joint]; }
  /// The joint still runs in the reference, but its module failed after it had sent its state. The module cannot be
  /// asked for its values, so the reference's are used.
  [[nodiscard]] bool stands_in_for(unsigned joint) const { return failed_[joint] && chain().is_running(joint); }
  /// Debounced touch sensors of a joint, in the bits of the state frame's flags.
  [[nodiscard]] std::uint8_t contacts(unsigned joint) const { return touch_.contacts()[joint]; }
  /// What the algorithms of each joint got in the tick, by joint.
  [[nodiscard]] std::span<const JointReadings> readings() const { return readings_; }
  [[nodiscard]] const KernelChain& chain() const { return gait_.chain(); }

 private:
  void fail(unsigned joint, HardwareReport& report);
  void stop(unsigned joint, HardwareReport& report);

  Gait gait_;
  TouchInputs touch_;
  std::vector<bool> failed_;  ///< by joint
  std::vector<JointReadings> readings_;
  std::vector<ServoPulse> expected_pulses_;
};

/// What the modules made of the last tick, in the order in which it is compared and recorded.
class ModuleValues {
 public:
  /// scenario, rack, reference: must outlive this.
  ModuleValues(const Scenario& scenario, const ModuleRack& rack, const ReferenceGait& reference);

  /// Called after ModuleRack::end_tick() and ReferenceGait::advance(). A module that does not compute keeps its last
  /// values.
  void read(std::uint32_t tick);
  /// After ModuleRack::end_tick(), when the reference no longer follows: what each module computed since the last one,
  /// whatever tick it was.
  void read_whatever();
  /// The pulses that the servos took. A failed module may repeat old ones; those are no part of the gait.
  void read_pulses(std::span<const PlantTicks::Reading> readings);

  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return setpoints_; }
  [[nodiscard]] std::span<const std::int32_t> internal_values() const { return internal_values_; }
  [[nodiscard]] std::span<const std::uint8_t> latched_contacts() const { return latched_contacts_; }  ///< by link
  /// The pulses of the tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const ServoPulse> pulses() const { return pulses_; }

 private:
  const Scenario& scenario_;
  const ModuleRack& rack_;
  const ReferenceGait& reference_;
  std::vector<std::int32_t> setpoints_;
  std::vector<std::int32_t> internal_values_;
  std::vector<std::uint8_t> latched_contacts_;
  std::vector<ServoPulse> pulses_;
};

}  // namespace proleg::sim
