#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/durations/durations.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/kernel/kernel.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "sim/bus/bus.hpp"
#include "sim/loop/difference.hpp"
#include "sim/loop/plant.hpp"

namespace proleg::sim {

/// How long after SYNC the modules give their servos the first pulse width that belongs to it. Ticks count in which a
/// servo interval starts with SYNC: at other ticks the program waits for the interval.
class CommandLatency {
 public:
  CommandLatency(const ServoSchedule& schedule, unsigned joints) : schedule_(schedule), joints_(joints) {}

  /// Begins a tick at its SYNC, before the modules receive it.
  void begin_tick(std::uint32_t tick, BusTime sync) {
    sync_ = sync;
    awaited_ = schedule_.first_start_us(tick) == 0 ? JointMask::first(joints_) : JointMask();
  }
  /// The module of a joint gives its servo a pulse width.
  void note_command(unsigned joint, BusTime time) {
    if (awaited_.contains(joint) && time >= sync_) {
      awaited_.erase(joint);
      nanoseconds_.add(time - sync_);
    }
  }

  /// The durations of all joints and ticks so far, in ns.
  [[nodiscard]] const Durations& nanoseconds() const { return nanoseconds_; }

 private:
  ServoSchedule schedule_;
  unsigned joints_;
  BusTime sync_ = 0;
  JointMask awaited_;
  Durations nanoseconds_;
};

/// The module of a joint stopped, or joined again.
struct RestartEvent {
  std::uint32_t joint;
  bool joined;
};

/// A module did not finish a tick although the run had not stopped it: its program hangs, has a fault, or was reset.
/// The module counts as stopped from then on, until it joins again.
struct ModuleFailure {
  std::uint32_t tick;
  unsigned joint;
};

/// What a module reported about itself (JointModule::take_problem()).
struct ModuleProblem {
  std::uint32_t tick;
  unsigned joint;
  std::string text;
  bool leaves_model;  ///< JointModule::leaves_model()
};

/// What a run with hardware in the loop has found so far.
struct HardwareReport {
  ValueHash setpoint_hash;
  ValueHash servo_hash;
  WorldHash world_hash;
  std::uint64_t differences = 0;                           ///< against the reference gait
  std::array<std::uint64_t, max_joints> differences_of{};  ///< by joint
  std::optional<Difference> first_difference;
  std::vector<ModuleFailure> failures;
  std::vector<ModuleProblem> problems;
  std::vector<std::uint32_t> dropped_changes;  ///< ticks of changes that did not take effect in any module
  std::vector<RestartEvent> restart_events;    ///< of the last tick
  std::uint64_t lost_frames = 0;               ///< state frames withheld from a receiver
  std::uint64_t receptions = 0;                ///< of state frames, also withheld ones
  std::uint64_t setup_frames = 0;              ///< frames on the bus before SYNC 0

  void add(const Difference& difference) {
    ++differences;
    ++differences_of[difference.joint];
    if (!first_difference) {
      first_difference = difference;
    }
  }
};

}  // namespace proleg::sim
