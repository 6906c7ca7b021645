#pragma once

// Hardware in the loop: the joints' own programs on a simulated CAN bus, and the world, in lock step on virtual time.
//
// Every module has its own joint, its sensors, the frames it receives and its own crystal, and nothing else. The world
// follows the modules' time: between SYNC k and k + 1 it makes the steps of one tick, however long the crystal makes
// that tick. The loop reads a servo in the middle of its interval and makes a step of the physics in the middle of the
// step, so that neither latency nor a crystal's error decides which pulse a step uses.
//
// Each tick is compared with the gait in memory (KernelChain) that has the same changes, losses, restarts and touch
// sensors: as long as nothing differs, the world is the one that a simulation without bus and modules would have.
//
// With a schedule of faults the comparison ends when the first fault begins. From then on a tick of the loop also ends
// when its SYNC is missing, so the world goes on whatever happens on the bus, and MotionWatch checks the rules of
// docs/safety.md.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include "shared/computer/durations/durations.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/hardware_report.hpp"
#include "sim/hardware_loop/motion_watch.hpp"
#include "sim/loop/difference.hpp"
#include "sim/loop/plant.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The robot did not start, or it stopped: what() names the module, what was found and what was expected.
class HardwareError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class HardwareLoop {
 public:
  /// The joint whose module produces the SYNC: the head.
  static constexpr unsigned sync_producer = 0;

  /// Switches the modules on, sets them up over the bus and starts the robot; SYNC 0 comes next.
  /// scenario: must outlive the loop. Throws HardwareError if the start fails, before anything has moved, and
  /// InputError for a robot whose frames could fill the bus.
  HardwareLoop(const Scenario& scenario, HardwareOptions options);
  ~HardwareLoop();
  HardwareLoop(const HardwareLoop&) = delete;
  HardwareLoop& operator=(const HardwareLoop&) = delete;

  /// One tick: SYNC k and all that follows until SYNC k + 1. Returns the change that took effect at k, if any.
  /// Throws PhysicsError as Simulation does, and HardwareError if the SYNC is missing for a second.
  const Change* advance();

  [[nodiscard]] std::uint32_t tick() const;
  [[nodiscard]] double time_s() const;
  [[nodiscard]] const Plant& plant() const;
  /// The last tick, as a recorder takes it; valid until the next advance().
  [[nodiscard]] TickSample sample();
  /// Joints whose modules stopped or joined again at the last tick.
  [[nodiscard]] std::span<const RestartEvent> restart_events() const;
  [[nodiscard]] std::span<const ModuleFailure> failures() const;
  [[nodiscard]] std::span<const ModuleProblem> problems() const;
  /// Ticks so far, by joint, in which its limits cut its set-point (in the gait in memory).
  [[nodiscard]] std::span<const std::uint32_t> clipped_ticks() const;
  /// Ticks of the changes so far that the master could not make: they did not take effect in any module.
  [[nodiscard]] std::span<const std::uint32_t> dropped_changes() const;

  /// What the modules did in a run with faults.
  [[nodiscard]] const MotionWatch& motion_watch() const;
  /// From SYNC to the first pulse width that belongs to it, in ns of bus time: in ticks whose first servo interval
  /// starts with SYNC. The program of a native module takes no time.
  [[nodiscard]] const Durations& command_latency_ns() const;
  /// Ends the watch of such a run: then motion_watch() has how it ended for each joint.
  void finish_watch();
  /// The first tick that was not compared, because a fault had begun; nothing: all were.
  [[nodiscard]] std::optional<std::uint32_t> first_fault_tick() const;

  [[nodiscard]] const ValueHash& setpoint_hash() const;
  [[nodiscard]] const ValueHash& servo_hash() const;
  /// Hash of the world after all ticks; nothing if its engine does not give the same on every computer.
  [[nodiscard]] std::optional<std::string> world_hash() const;
  [[nodiscard]] std::string motion_hash() const;
  /// Set-points and servo commands that differ from the gait in memory, so far, and the first of them.
  [[nodiscard]] std::uint64_t differences() const;
  /// Set-points and servo commands of one joint that differ from the gait in memory, so far.
  [[nodiscard]] std::uint64_t differences(unsigned joint) const;
  [[nodiscard]] const std::optional<Difference>& first_difference() const;
  /// State frames withheld from a receiver.
  [[nodiscard]] std::uint64_t lost_frames() const;
  /// State frames by receiver, also those withheld.
  [[nodiscard]] std::uint64_t receptions() const;
  /// Frames on the bus and the share of time that they took, from SYNC 0 on.
  [[nodiscard]] BusStatistics bus_statistics() const;
  /// Frames on the bus before SYNC 0.
  [[nodiscard]] std::uint64_t setup_frames() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
