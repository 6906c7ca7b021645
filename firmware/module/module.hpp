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
  /// Does what is due; to be called at next_deadline() or later.
  void poll(Microseconds now);
  /// Later than the `now` of the poll() before it, if nothing else was called since.
  [[nodiscard]] Microseconds next_deadline() const;

  /// The joint's kernel, for tests and the simulator's comparison. Configured from `activate` on.
  [[nodiscard]] const Kernel& kernel() const { return parts_.joint.kernel(); }

  // What the module is at; for tests and displays.
  [[nodiscard]] canopen::NmtState state() const { return parts_.network.state(); }
  [[nodiscard]] canopen::PowerState power() const { return parts_.drive.power().state(); }
  /// Whether the module computes in the robot's tick.
  [[nodiscard]] bool synchronised() const { return keeper_.synchronised(); }
  /// Frames that found no room in the queue, since the reset.
  [[nodiscard]] std::uint32_t dropped_frames() const { return parts_.outbox.dropped(); }
  /// State frames whose label was more than a tick away from the coming one, since Operational was entered.
  [[nodiscard]] std::uint32_t unknown_labels() const { return parts_.neighbours.unknown_labels(); }

 private:
  /// Silence of SYNC that leads to a quick stop.
  static constexpr Microseconds longest_sync_silence_us = 500'000;

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
  void watch_host(Microseconds now);
  void watch_sync(Microseconds now);
  /// Ends every event: the servo and the watch over SYNC follow from the state that it left.
  void settle(Microseconds now);

  Parts parts_;
  DeviceObjects objects_;
  TickKeeper keeper_;

  bool collided_ = false;
  bool sync_heard_ = false;                               ///< since Operational was left: the robot moves already
  bool start_sent_ = false;                               ///< the frame of state 0, since Operational was entered
  bool wrong_command_ = false;                            ///< was complained of
  std::optional<canopen::CommitMessage> refused_commit_;  ///< was complained of
  Microseconds sync_silence_ends_ = never;
};

}  // namespace proleg::firmware
