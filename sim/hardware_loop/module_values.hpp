#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/hardware_loop/module_rack.hpp"
#include "sim/hardware_loop/plant_ticks.hpp"
#include "sim/hardware_loop/reference_gait.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What the modules made of the last tick, in the order in which it is compared and recorded.
class ModuleValues {
 public:
  /// scenario, rack, reference: must outlive this.
  ModuleValues(const Scenario& scenario, const ModuleRack& rack, const ReferenceGait& reference);

  /// After ModuleRack::end_tick() and ReferenceGait::advance(). A module that does not compute keeps its last values.
  void read(std::uint32_t tick);
  /// After ModuleRack::end_tick(), when the reference no longer follows: what each module computed since the last one,
  /// whatever tick it was.
  void read_whatever();
  /// The pulses that the servos took. A failed module may repeat old ones; those are no part of the gait.
  void read_pulses(std::span<const PlantTicks::Reading> readings);

  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return setpoints_; }
  [[nodiscard]] std::span<const std::int32_t> internal_values() const { return internal_values_; }
  [[nodiscard]] std::span<const std::uint8_t> latched_contacts() const { return latched_contacts_; }  ///< by link
  /// In the order of time, then of joints.
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
