#pragma once

// A simulated robot on a simulated bus that other programs reach: the modules, their servos and the world, without a
// master and without a comparison. The caller advances the time, in all states of the robot, with or without a host.
//
// The world makes its steps tick by tick. While a module produces SYNC, a tick of the world begins with it, as in
// HardwareLoop; without SYNC a tick follows the one before after the tick period. So the world moves on in a quick stop
// too, and before the start.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/hardware_loop/plant_ticks.hpp"
#include "sim/loop/plant.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

struct LiveRobotOptions {
  /// Makes the modules (HardwareOptions::make_module).
  std::function<std::unique_ptr<JointModule>(const ModuleParts&)> make_module;
  std::function<void(unsigned joint, firmware::ModuleIdentity& identity)> change_identity;
  std::uint32_t crystal_error_ppm = 100;
  unsigned threads = 1;  ///< HardwareOptions::threads
  /// The host of a gateway (HardwareOptions). It sends characters from outside not before LiveRobot::now() plus 200 us,
  /// because the program of a module may run ahead of the bus.
  std::optional<HardwareOptions::GatewayHost> gateway;
  /// Called for each frame that ends on the bus, before any node receives it. own: LiveRobot::send() was its source.
  std::function<void(const Transmission& transmission, bool own)> on_frame;
  /// Called when a frame of send() was on the bus, in the order of send().
  std::function<void(BusTime time, const CanFrame& frame, std::uint32_t source)> on_sent;
  /// Called when the adapter's controller has another error state.
  std::function<void(const Controller& adapter)> on_state;
  /// Called with each report of a module, one line: a fault of its program, a reset.
  std::function<void(const std::string&)> notice;
};

class LiveRobot final : private BusListener {
 public:
  /// Largest number of frames from outside that wait for the bus.
  static constexpr std::size_t max_waiting = 1'024;

  /// Switches the modules on at time 0. scenario must outlive the robot. Throws InputError for a scenario whose modules
  /// CAN cannot carry.
  LiveRobot(const Scenario& scenario, LiveRobotOptions options);
  LiveRobot(const LiveRobot&) = delete;
  LiveRobot& operator=(const LiveRobot&) = delete;

  /// Present time since the modules were switched on: all events up to it have happened.
  [[nodiscard]] BusTime now() const { return bus_.now(); }
  /// Time of the next event, if no frame is sent before.
  [[nodiscard]] BusTime next_event() const;
  /// Processes all events up to a time. Throws PhysicsError as Simulation does.
  void advance_to(BusTime time);
  /// Processes events up to a time, or up to one at which options.on_frame or options.on_sent were called.
  void advance_to_frame(BusTime time);

  /// Sends a frame of an outside program at now(), by the controller of the adapter between it and the bus. on_sent
  /// returns `source`. Returns false if max_waiting frames wait already.
  [[nodiscard]] bool send(const CanFrame& frame, std::uint32_t source = 0);
  [[nodiscard]] std::size_t waiting() const { return waiting_.size() + in_mailboxes_.size(); }
  /// The controller of the adapter.
  [[nodiscard]] const Controller& adapter() const { return adapter_; }

  [[nodiscard]] JointModule& module(unsigned joint) { return rack_.module(joint); }
  [[nodiscard]] unsigned joint_count() const { return rack_.size(); }
  [[nodiscard]] Plant& plant() { return plant_; }
  [[nodiscard]] Bus& bus() { return bus_; }
  /// Number of complete ticks of the world.
  [[nodiscard]] std::uint32_t ticks() const { return ticks_; }

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime time, const CanFrame& frame) override;
  void error_state_changed(BusTime time) override;

  /// Processes all events up to a time, or up to a frame. Returns whether it reached the time.
  bool run_events(BusTime time, bool ends_with_frame);
  void on_frame(const Transmission& transmission);
  void fill_mailboxes();
  [[nodiscard]] BusTime tick_period() const { return BusTime{scenario_.kernel.tick_period_us} * 1'000; }
  [[nodiscard]] BusTime tick_deadline() const;
  void take_sync(BusTime now);
  void begin_tick(BusTime now, bool has_sync);
  void take_problems();

  const Scenario& scenario_;
  LiveRobotOptions options_;
  HardwareOptions rack_options_;  ///< options for the rack
  Plant plant_;
  PlantTicks plant_ticks_;
  Bus bus_;
  ModuleRack rack_;  ///< it attaches to the bus first
  Controller& adapter_;
  struct Request {
    CanFrame frame;
    std::uint32_t source;
  };
  std::deque<Request> waiting_;
  std::deque<Request> in_mailboxes_;
  bool has_had_frame_ = false;  ///< the last event had a frame
  std::uint32_t ticks_ = 0;
  std::uint32_t begun_ticks_ = 0;
  BusTime tick_begin_ = 0;     ///< begin of the last tick
  bool follows_sync_ = false;  ///< the last tick began with a SYNC
};

}  // namespace proleg::sim
