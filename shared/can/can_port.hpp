#pragma once

#include <span>

#include "shared/can/can_frame.hpp"
#include "shared/can/can_status.hpp"

namespace proleg {

/// Time on the clock of a node: microseconds since power-on.
using Microseconds = std::uint64_t;
/// A deadline that never comes.
inline constexpr Microseconds never = ~Microseconds{0};

/// NMT, SYNC and EMCY have identifiers below this. One mailbox of a controller is for them only, so that waiting frames
/// with higher identifiers do not delay them.
inline constexpr std::uint16_t end_of_urgent_identifiers = 0x100;

/// A node's output to the bus. The node receives frames, and the report that a frame was sent, as events.
class CanPort {
 public:
  /// Passes a frame to the controller, which sends it when the bus is free, lower identifiers first. False if all its
  /// mailboxes are full: try again after the next frame was sent.
  [[nodiscard]] virtual bool send(const CanFrame& frame) = 0;
  /// Sets the owner's node id; 0, as before the first call: none. The controller may discard frames to other nodes:
  /// RPDO1, SDO and all others that have the node id in their identifier.
  virtual void set_node(std::uint8_t /*node*/) {}
  /// Selects the state frames (0x181 to 0x1FF, 0x281 to 0x2FF) that the owner needs; before the first call it needs
  /// none. The controller may discard other state frames. It receives all frames that are not state frames.
  virtual void listen(std::span<const std::uint16_t> /*identifiers*/) {}
  /// Sets whether the owner needs all data frames with 11-bit identifiers, whatever set_node() and listen() say. Before
  /// the first call it does not. A gateway with a host on its line does.
  virtual void receive_all(bool /*all*/) {}
  /// The present error state of the controller.
  [[nodiscard]] virtual CanStatus status() { return {}; }
  /// Kinds of errors that the controller has seen since the last call; not necessarily all of them.
  [[nodiscard]] virtual CanErrors take_errors() { return {}; }
  /// Starts the recovery from bus-off (ISO 11898-1, 6.13). In bus-off the controller has stopped after too many errors
  /// and has dropped all waiting frames. The recovery takes 128 times 11 recessive bits. Controllers that recover by
  /// themselves ignore the call.
  virtual void recover() {}

 protected:
  ~CanPort() = default;
};

}  // namespace proleg
