#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/module/module.hpp"
#include "shared/computer/threads/worker_threads.hpp"
#include "shared/kernel/kernel.hpp"
#include "sim/hardware_loop/crystal.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/hardware_report.hpp"
#include "sim/loop/plant.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The crystal of a joint's module: off by up to error_ppm, by an amount that follows from the scenario's seed.
[[nodiscard]] Crystal make_crystal(const Scenario& scenario, std::size_t joint, std::uint32_t error_ppm);

/// The identity of a joint's module: its node id; a unique id that follows from the scenario's seed, or has the serial
/// number that the robot's file names; this program's core; a feedback potentiometer.
[[nodiscard]] firmware::ModuleIdentity make_identity(const Scenario& scenario, std::size_t joint);

/// The joint modules on the bus: makes them, restarts them when the run says so, and reads what they computed.
class ModuleRack {
 public:
  /// Makes the module of each joint and attaches it to the bus, switched off. All arguments must outlive the rack. The
  /// rack must be the first to attach: the index of a module's controller is its joint.
  ModuleRack(Bus& bus, const Plant& plant, const Scenario& scenario, const HardwareOptions& options);

  [[nodiscard]] unsigned size() const { return static_cast<unsigned>(modules_.size()); }
  [[nodiscard]] std::size_t controller(unsigned joint) const { return modules_[joint]->controller(); }
  [[nodiscard]] JointModule& module(unsigned joint) { return *modules_[joint]; }

  /// Called with the joint and each pulse of its servo, as JointModule::PulseWatch has it.
  using PulseWatch = std::function<void(unsigned joint, const JointModule::WatchedPulse& pulse)>;
  void watch_pulses(const PulseWatch& watch);
  /// Called with the joint and each pulse width for its servo, as JointModule::CommandWatch has it.
  using CommandWatch = std::function<void(unsigned joint, BusTime time)>;
  void watch_commands(const CommandWatch& watch);

  void power_on(BusTime now);
  [[nodiscard]] BusTime next_event() const;
  /// quiet_until: as JointModule::advance_to() has it. ahead_until: before this nothing but modules acts, so that they
  /// may be prepared (JointModule::prepare()): no module is advanced, changed or read by others than the rack, and no
  /// signal of a pin changes.
  void advance_to(BusTime now, BusTime quiet_until, BusTime ahead_until);

  /// Calls JointModule::catch_up_before() of each module.
  void catch_up_before(BusTime time);

  /// Begins a tick at its SYNC, before the modules receive it: restarts the modules that are due.
  void begin_tick(std::uint32_t tick, BusTime now);
  /// Begins a tick whose SYNC has not come.
  void begin_tick_without_sync(std::uint32_t tick, BusTime now);
  /// Ends a tick at the next SYNC, before the modules receive it: reads what they computed.
  void end_tick();

  /// What a module had computed at the last end_tick().
  [[nodiscard]] const firmware::TickRecord& record(unsigned joint) const { return records_[joint]; }
  [[nodiscard]] bool has_computed(unsigned joint, std::uint32_t tick) const {
    return sim::has_computed(records_[joint], joint, tick);
  }
  /// Whether a module computed something between the last two end_tick(), whatever tick it was for it.
  [[nodiscard]] bool has_computed_anew(unsigned joint) const {
    return records_[joint].tick != firmware::TickRecord::none && records_[joint].tick != ticks_before_[joint];
  }
  /// Whether the run restarted the module of the joint at the last SYNC.
  [[nodiscard]] bool has_restarted(unsigned joint) const { return restarted_.contains(joint); }

  /// The pulse that the servo of a joint gets now.
  [[nodiscard]] std::optional<std::int32_t> pulse(unsigned joint) const { return modules_[joint]->pulse(); }
  /// The pulse that a servo gets now, or got before the restart if its module restarted at the last SYNC.
  [[nodiscard]] std::optional<std::int32_t> pulse_before_restart(unsigned joint) const {
    return has_restarted(joint) ? last_pulses_[joint] : pulse(joint);
  }

  /// Moves the problems that modules have reported since the last call into the report.
  void take_problems(std::uint32_t tick, HardwareReport& report);

 private:
  [[nodiscard]] BusTime next_serial_input() const;
  void take_serial_input(BusTime now);
  [[nodiscard]] std::unique_ptr<JointModule> make_native(const ModuleParts& parts) const;
  void make_due_restarts(std::uint32_t tick, BusTime now);
  void restart(unsigned joint, BusTime now);
  void prepare(BusTime now, BusTime quiet_until, BusTime ahead_until);

  Bus& bus_;
  const Scenario& scenario_;
  const HardwareOptions& options_;
  std::vector<std::unique_ptr<JointModule>> modules_;  ///< by joint
  std::vector<firmware::TickRecord> records_;          ///< by joint
  std::vector<std::uint32_t> ticks_before_;            ///< by joint: of the record before
  std::vector<unsigned> preparations_;                 ///< joints of the modules that are prepared now
  std::vector<BusTime> prepared_from_;                 ///< by joint
  WorkerThreads threads_;
  std::size_t next_restart_ = 0;
  JointMask restarted_;
  std::array<std::optional<std::int32_t>, max_joints> last_pulses_;  ///< of modules that restarted, before that
};

}  // namespace proleg::sim
