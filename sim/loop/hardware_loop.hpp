#pragma once

// Hardware in the loop: the joints' own programs on a simulated CAN bus, and the world, in lock step on virtual time.
//
// Every module knows only its own joint, its sensors and the frames it hears, and runs on its own crystal. The world's
// time is the modules' time: between SYNC k and k + 1 it makes the steps of one tick, whatever a crystal makes of its
// length. A servo is read in the middle of its interval and a step of the physics is made at its own middle, so that
// neither latency nor a crystal's error decides which pulse a step sees.
//
// Each tick is compared with the gait in memory (KernelChain) that has the same changes, losses, restarts and touch
// sensors: as long as nothing differs, the world is the one that a simulation without bus and modules would have.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/module/board.hpp"
#include "firmware/module/ports.hpp"
#include "shared/computer/hash/value_hash.hpp"
#include "sim/bus/bus.hpp"
#include "sim/loop/crystal.hpp"
#include "sim/loop/difference.hpp"
#include "sim/loop/injector.hpp"
#include "sim/loop/joint_module.hpp"
#include "sim/loop/kernel_chain.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/touch_inputs.hpp"
#include "sim/record/recorder.hpp"

namespace proleg::sim {

/// The robot could not be brought up, or stopped: what() names the module, what was found and what was expected.
class HardwareError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A module restarts at the instant of a SYNC, which it does not hear any more.
struct Restart {
  std::uint32_t tick;
  unsigned joint;
};

/// What a joint module of the loop is made with.
struct ModuleParts {
  Bus& bus;
  unsigned joint;
  firmware::Board board;
  Crystal crystal;
  std::function<std::uint8_t()> sensors;              ///< touch sensors wired to it, as firmware::ContactPort::read()
  std::function<firmware::ServoReadings()> readings;  ///< of its servo and chip, at this moment
};

struct HardwareOptions {
  /// Makes the module of a joint; null, or one that returns null: a native one.
  std::function<std::unique_ptr<JointModule>(const ModuleParts&)> make_module;
  const Losses* losses = nullptr;       ///< must outlive the loop
  std::vector<Restart> restarts;        ///< by ascending tick
  std::vector<InjectedFrame> injected;  ///< by ascending tick; from a node of its own
  /// Frames destroyed on the bus, which are sent again: which ones, follows from the seed.
  struct BitErrors {
    std::uint64_t seed = 0;
    std::uint32_t threshold = 0;  ///< probability for a frame, times 2^32
  };
  BitErrors bit_errors;
  /// Called for each frame on the bus when it ends, with the time since the modules were switched on.
  Bus::Trace trace;
  /// Called for what modules report by EMCY and for restarts, one line each.
  std::function<void(const std::string&)> notice;
  /// Crystals are off by up to this, each by an amount that follows from the scenario's seed.
  std::uint32_t crystal_error_ppm = 100;
  /// For tests: what the boards are, and what happens to a frame on its way into the program of a joint's module.
  std::function<void(unsigned joint, firmware::Board& board)> change_board;
  std::function<void(unsigned joint, const CanFrame& frame, const std::function<void(const CanFrame&)>& deliver)>
      tamper;
  /// For tests: the touch sensors that a module reads instead.
  std::function<std::uint8_t(unsigned joint, std::uint8_t sensors)> change_sensors;
};

class HardwareLoop {
 public:
  /// The joint whose module produces the SYNC: the head.
  static constexpr unsigned sync_producer = 0;

  /// Switches the modules on, sets them up over the bus and starts the robot; SYNC 0 comes next.
  /// scenario: must outlive the loop. Throws HardwareError if that fails: nothing has moved then; and InputError for a
  /// robot whose frames could fill the bus.
  HardwareLoop(const Scenario& scenario, HardwareOptions options);
  ~HardwareLoop();
  HardwareLoop(const HardwareLoop&) = delete;
  HardwareLoop& operator=(const HardwareLoop&) = delete;

  /// One tick: SYNC k and all that follows until SYNC k + 1. Returns the change that took effect at k, if any.
  /// Throws PhysicsError as Simulation does, and HardwareError if the SYNC stays out.
  const Change* advance();

  [[nodiscard]] std::uint32_t tick() const;
  [[nodiscard]] double time_s() const;
  [[nodiscard]] const Plant& plant() const;
  /// Of the last tick, to be recorded; valid until the next advance().
  [[nodiscard]] TickSample sample();
  /// Joints whose modules stopped or joined again at the last tick.
  struct RestartEvent {
    std::uint32_t joint;
    bool joined;
  };
  [[nodiscard]] std::span<const RestartEvent> restart_events() const;
  /// A module that did not bring a tick to its end though the run had not stopped it: its program hangs, has a fault,
  /// or was reset. It counts as stopped from then on, until it joins again.
  struct Failure {
    std::uint32_t tick;
    unsigned joint;
  };
  [[nodiscard]] std::span<const Failure> failures() const;
  /// What modules said of themselves (JointModule::take_problem()).
  struct Problem {
    std::uint32_t tick;
    unsigned joint;
    std::string text;
  };
  [[nodiscard]] std::span<const Problem> problems() const;

  [[nodiscard]] const ValueHash& setpoint_hash() const;
  [[nodiscard]] const ValueHash& servo_hash() const;
  /// Set-points and servo commands that differ from the gait in memory, so far, and the first of them.
  [[nodiscard]] std::uint64_t differences() const;
  /// Those of one joint.
  [[nodiscard]] std::uint64_t differences(unsigned joint) const;
  [[nodiscard]] const std::optional<Difference>& first_difference() const;
  /// State frames that were kept from a receiver.
  [[nodiscard]] std::uint64_t lost_frames() const;
  /// Frames on the bus and the part of the time that they took, from SYNC 0 on.
  [[nodiscard]] BusStatistics bus_statistics() const;
  /// Frames that it took to set the robot up.
  [[nodiscard]] std::uint64_t setup_frames() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
