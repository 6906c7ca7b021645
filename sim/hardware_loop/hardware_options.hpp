#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/module/module_identity.hpp"
#include "firmware/module/ports.hpp"
#include "sim/bus/bus.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/crystal.hpp"
#include "sim/hardware_loop/joint_module.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

/// A frame that a node other than host and modules sends on the bus, right after a SYNC.
struct InjectedFrame {
  std::uint32_t tick;
  CanFrame frame;
};

/// A node that sends given frames and ignores what it receives.
class Injector final : private BusListener {
 public:
  /// Attaches to the bus. frames: by ascending tick; they must outlive the injector.
  Injector(Bus& bus, std::span<const InjectedFrame> frames) : frames_(frames), controller_(bus.attach(*this)) {}
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  /// Sends a frame now, after those that wait.
  void send_now(const CanFrame& frame) {
    pending_.push_back(frame);
    send();
  }

  /// Sends the frames that are due at the SYNC of this tick.
  void advance_to(std::uint32_t tick) {
    for (; !frames_.empty() && frames_.front().tick <= tick; frames_ = frames_.subspan(1)) {
      pending_.push_back(frames_.front().frame);
    }
    send();
  }

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override { send(); }

  void send() {
    while (!pending_.empty() && controller_.send(pending_.front())) {
      pending_.pop_front();
    }
  }

  std::span<const InjectedFrame> frames_;
  std::deque<CanFrame> pending_;
  Controller& controller_;
};

/// A module restarts at the instant of a SYNC, which it does not receive.
struct Restart {
  std::uint32_t tick;
  unsigned joint;
};

/// What a joint module of the loop is made with.
struct ModuleParts {
  Bus& bus;
  unsigned joint;
  firmware::ModuleIdentity identity;
  Crystal crystal;
  std::function<std::uint8_t()> sensors;    ///< its touch sensors: as firmware::ContactPort::read_contacts()
  std::function<ServoReadings()> readings;  ///< of its servo and chip, at this moment
  /// Readings whose current is the mean since the last call, as firmware::SensorPort has it.
  std::function<ServoReadings()> take_readings;
  bool is_gateway = false;  ///< its board record says so
};

struct HardwareOptions {
  /// Makes the module of a joint; null, or one that returns null: a native one.
  std::function<std::unique_ptr<JointModule>(const ModuleParts&)> make_module;
  const Losses* losses = nullptr;       ///< must outlive the loop
  std::vector<Restart> restarts;        ///< by ascending tick
  std::vector<InjectedFrame> injected;  ///< by ascending tick; sent by a node that is no module
  /// Frames destroyed on the bus, which are sent again. The seed decides which ones.
  struct BitErrors {
    std::uint64_t seed = 0;
    std::uint32_t threshold = 0;  ///< probability for a frame, times 2^32
  };
  BitErrors bit_errors;
  FaultSchedule faults;
  /// The module of this joint is a gateway, with a host on its serial line.
  struct GatewayHost {
    unsigned joint;
    SerialHost* host;  ///< must outlive the loop
  };
  std::optional<GatewayHost> gateway;
  /// Called once, when scenario and options are checked and before the modules are switched on: from here on files may
  /// be written.
  std::function<void()> before_start;
  /// Called for each frame on the bus when it ends, with the time since the modules were switched on.
  Bus::FrameListener on_frame;
  /// Called for what modules report by EMCY and for restarts, one line each.
  std::function<void(const std::string&)> notice;
  /// Time from power on of a native module to the start of its program: 0, or what the bootloader of a chip needs.
  std::uint32_t start_time_us = 0;
  /// Crystals are off by up to this, each by an amount that follows from the scenario's seed.
  std::uint32_t crystal_error_ppm = 100;
  /// Threads on which virtual chips run, at least 1. The result does not depend on it.
  unsigned threads = 1;
  /// A hook for tests: changes the identities of the modules, and frames on their way into the program of a joint's
  /// module.
  std::function<void(unsigned joint, firmware::ModuleIdentity& identity)> change_identity;
  std::function<void(unsigned joint, const CanFrame& frame, const std::function<void(const CanFrame&)>& deliver)>
      tamper;
  /// A hook for tests: the touch sensors that a module reads instead.
  std::function<std::uint8_t(unsigned joint, std::uint8_t sensors)> change_sensors;
};

}  // namespace proleg::sim
