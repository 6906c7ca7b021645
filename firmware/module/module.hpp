#pragma once

// The program of a joint module: a CANopen device that computes the state of its one joint. It is a state machine:
// events come in (power on, frames received and sent, deadlines), frames and pulses go out; it never waits. All times
// are on the module's own clock.

#include "firmware/module/device_objects.hpp"

namespace proleg::firmware {

/// Passes each event to the part or function that handles it, then updates what follows from the new state.
class Module {
 public:
  /// Nothing happens before power_on(). The objects of the ports must outlive the module.
  Module(const ModuleIdentity& identity, const Ports& ports);

  /// Starts from reset with the settings of the board. Sends boot-up after a delay that follows from the unique id, so
  /// that one of two modules with the same node id receives the other's message. Without a node id it only serves LSS,
  /// and sends boot-up when it was given one.
  void power_on(Microseconds now);
  void receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller is bus-off (ISO 11898-1, 6.13): quick stop; pending frames are dropped. The
  /// module asks the controller to come back, after a pause that grows (BusRecovery), until bus_back() is called.
  void bus_off(Microseconds now);
  /// Must be called when the controller takes part in the bus again, whether it was asked to or not.
  void bus_back(Microseconds now);
  /// Must be called when the controller or its driver had no room for received frames. count: since the start.
  void frames_lost(Microseconds now, std::uint32_t count);
  [[nodiscard]] std::uint32_t lost_frames() const { return parts_.losses.count(); }
  /// Must be called when the supply voltage is too low (no pulses, Fault) and when it is good again. Then pulses need a
  /// decision, as after each fault.
  void supply_low(Microseconds now);
  void supply_good(Microseconds now);
  [[nodiscard]] bool is_supply_low() const { return parts_.is_supply_low; }
  /// Does what is due. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  /// Time of the next poll(). It is later than the `now` of the last one, if nothing else was called since.
  [[nodiscard]] Microseconds next_deadline() const {
    const Microseconds of_line = parts_.gateway.next_deadline();
    return of_line < next_deadline_ ? of_line : next_deadline_;
  }
  /// Reads and writes the serial line of a gateway (LinePort). Must be called after other events, and when characters
  /// were received or sent. True if there is more to read: call it again soon.
  bool serve_line(Microseconds now);

  /// The joint's kernel, for tests and the simulator's comparison. It is configured from `activate` on.
  [[nodiscard]] const Kernel& kernel() const { return parts_.joint.kernel(); }

  /// Record of the last tick. Its tick is `none` after a reset, a start, a join or the end of Operational, until the
  /// next tick is computed.
  [[nodiscard]] const TickRecord& last_tick() const { return parts_.joint.record(); }

  // The module's state, for tests and displays.
  /// The node id in use; 0: none.
  [[nodiscard]] std::uint8_t node() const { return parts_.identity.node; }
  [[nodiscard]] canopen::NmtState state() const { return parts_.network.state(); }
  [[nodiscard]] canopen::PowerState power() const { return parts_.drive.power().state(); }
  /// Whether the module computes in the tick of the robot.
  [[nodiscard]] bool synchronised() const { return parts_.keeper.synchronised(); }
  /// Number of frames that were dropped since the reset, because the queue was full or the controller bus-off.
  [[nodiscard]] std::uint32_t dropped_frames() const { return parts_.outbox.dropped(); }
  /// Whether the controller is bus-off, according to bus_off() and bus_back().
  [[nodiscard]] bool is_bus_off() const { return parts_.recovery.is_off(); }
  [[nodiscard]] const Gateway& gateway() const { return parts_.gateway; }
  /// Number of state frames whose label was more than a tick away from the coming one, since Operational was entered.
  [[nodiscard]] std::uint32_t unknown_labels() const { return parts_.neighbours.unknown_labels(); }

 private:
  void handle(Microseconds now, const CanFrame& frame);
  [[nodiscard]] bool receive_state(const CanFrame& frame);
  void dispatch(Microseconds now, const CanFrame& frame);
  void receive_update(Microseconds now, const CanFrame& frame);
  void receive_lss(Microseconds now, const CanFrame& frame);
  void receive_network_command(Microseconds now, const CanFrame& frame);
  void poll_parts(Microseconds now);
  void finish_event(Microseconds now);
  void find_deadlines();

  Parts parts_;
  DeviceObjects objects_{parts_};

  Microseconds deadline_of_parts_ = never;  ///< deadline of all parts but the servo
  Microseconds next_deadline_ = never;
};

}  // namespace proleg::firmware
