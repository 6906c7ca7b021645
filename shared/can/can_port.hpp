#pragma once

#include <span>

#include "shared/can/can_frame.hpp"
#include "shared/can/can_status.hpp"

namespace proleg {

/// Time on the clock of a node: microseconds since power-on.
using Microseconds = std::uint64_t;
/// A deadline that never comes.
inline constexpr Microseconds never = ~Microseconds{0};

/// NMT, SYNC and EMCY have identifiers below this. Of the mailboxes of a controller one is for them: frames that others
/// outbid must not hold them up.
inline constexpr std::uint16_t end_of_urgent_identifiers = 0x100;

/// The output to the bus. Received frames, and that a frame was sent, reach the owner as events.
class CanPort {
 public:
  /// Hands a frame to the controller, which sends it when the bus is free, lower identifiers first.
  /// False if all its mailboxes are full: try again after the next frame was sent.
  [[nodiscard]] virtual bool send(const CanFrame& frame) = 0;
  /// The owner's node id from now on; 0: none, as before the first call. The controller may discard frames to other
  /// nodes: RPDO1, SDO and whatever else has the node id in its identifier.
  virtual void set_node(std::uint8_t /*node*/) {}
  /// Selects the state frames (0x181 to 0x1FF, 0x281 to 0x2FF) that the owner needs; before the first call it needs
  /// none. The controller may discard others. All frames with other identifiers are always received.
  virtual void listen(std::span<const std::uint16_t> /*identifiers*/) {}
  /// Whether the owner needs all data frames with 11-bit identifiers, whatever set_node() and listen() say; before the
  /// first call it does not. A gateway with a host on its line does.
  virtual void receive_all(bool /*all*/) {}
  /// The error state of the controller now.
  [[nodiscard]] virtual CanStatus status() { return {}; }
  /// Kinds of errors that the controller has seen since the last call; not necessarily all of them.
  [[nodiscard]] virtual CanErrors take_errors() { return {}; }
  /// Starts the recovery from bus-off (ISO 11898-1, 6.13), in which the controller has stopped after too many errors
  /// and has dropped all frames that waited. It takes 128 times 11 recessive bits. Controllers that recover by
  /// themselves ignore the call.
  virtual void recover() {}

 protected:
  ~CanPort() = default;
};

}  // namespace proleg
