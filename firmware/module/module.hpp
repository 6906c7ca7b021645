#pragma once

// The program of a joint module: a CANopen device that computes the state of its one joint. A plain state machine:
// events in (power on, frames received and sent, deadlines), frames and pulses out; it never waits. All times are those
// of the module's own clock.

#include "firmware/module/device_objects.hpp"
#include "firmware/module/tick_keeper.hpp"

namespace proleg::firmware {

class Module {
 public:
  /// Nothing happens before power_on(). What the ports refer to must outlive the module.
  Module(const Board& board, const Ports& ports);

  /// Starts from reset: nothing is known but the board. Sends boot-up after a delay that follows from the unique id, so
  /// that two modules with one node id hear each other.
  void power_on(Microseconds now);
  void receive(Microseconds now, const CanFrame& frame);
  /// The controller has sent a frame.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// The controller is bus-off (ISO 11898-1, 6.13): quick stop, what was to be sent is forgotten. The module asks
  /// the controller to come back, after a pause that grows (BusRecovery), until bus_back() is called.
  void bus_off(Microseconds now);
  /// The controller takes part in the bus again; also one that did so by itself.
  void bus_back(Microseconds now);
  /// Does what is due; to be called at next_deadline() or later.
  void poll(Microseconds now);
  /// Later than the `now` of the poll() before it, if nothing else was called since.
  [[nodiscard]] Microseconds next_deadline() const { return next_deadline_; }

  /// The joint's kernel, for tests and the simulator's comparison. Configured from `activate` on.
  [[nodiscard]] const Kernel& kernel() const { return parts_.joint.kernel(); }

  /// What was computed at the last tick; its tick is `none` from reset, a start, a place taken in a robot that moves,
  /// or the end of Operational on, until the next tick is computed.
  [[nodiscard]] const TickRecord& last_tick() const { return parts_.joint.record(); }

  // What the module is at; for tests and displays.
  [[nodiscard]] canopen::NmtState state() const { return parts_.network.state(); }
  [[nodiscard]] canopen::PowerState power() const { return parts_.drive.power().state(); }
  /// Whether the module computes in the robot's tick.
  [[nodiscard]] bool synchronised() const { return keeper_.synchronised(); }
  /// Frames that found no room in the queue, or no bus, since the reset.
  [[nodiscard]] std::uint32_t dropped_frames() const { return parts_.outbox.dropped(); }
  /// Whether the controller is bus-off, by what bus_off() and bus_back() said.
  [[nodiscard]] bool is_bus_off() const { return parts_.recovery.is_off(); }
  /// State frames whose label was more than a tick away from the coming one, since Operational was entered.
  [[nodiscard]] std::uint32_t unknown_labels() const { return parts_.neighbours.unknown_labels(); }

 private:
  /// Silence of SYNC that leads to a quick stop.
  static constexpr Microseconds longest_sync_silence_us = 500'000;

  void reset(Microseconds now);
  [[nodiscard]] bool is_own(std::uint16_t identifier) const;
  void dispatch(Microseconds now, const CanFrame& frame);
  void collide(std::uint16_t identifier);
  void on_network_command(Microseconds now, const CanFrame& frame);
  void on_heartbeat(Microseconds now, const CanFrame& frame);
  void on_tick(const CanFrame& frame);
  void on_sync(Microseconds now, const CanFrame& frame);
  void on_commit(const CanFrame& frame);
  void on_command(const CanFrame& frame);

  void enter_operational(bool together);
  void leave_operational(canopen::NmtState state);
  void prepare_start();
  void compute(Microseconds now, const SyncMeaning& meaning);
  void send_state();
  void send_monitoring(std::uint32_t tick);
  void read_servo(Microseconds now);
  void tell_reset_cause();
  void watch_host(Microseconds now);
  void watch_sync(Microseconds now);
  /// Ends every event: the servo and the watch over SYNC follow from the state that it left.
  void settle(Microseconds now);
  [[nodiscard]] bool receive_state(const CanFrame& frame);
  void poll_parts(Microseconds now);
  void find_deadlines();

  Parts parts_;
  DeviceObjects objects_;
  TickKeeper keeper_;

  bool boot_up_sent_ = false;  ///< the message has gone
  bool reset_cause_told_ = true;
  bool collided_ = false;
  bool sync_heard_ = false;                               ///< since Operational was left: the robot moves already
  bool start_sent_ = false;                               ///< the frame of state 0, since Operational was entered
  bool wrong_command_ = false;                            ///< was complained of
  std::optional<canopen::CommitMessage> refused_commit_;  ///< was complained of
  Microseconds sync_silence_ends_ = never;
  Microseconds deadline_of_parts_ = never;  ///< of all but the servo
  Microseconds next_deadline_ = never;
};

}  // namespace proleg::firmware
