#pragma once

#include <span>

#include "shared/can/can_frame.hpp"

namespace proleg {

/// Time on a node's own clock: microseconds since it was switched on.
using Microseconds = std::uint64_t;
/// A deadline that never comes.
inline constexpr Microseconds never = ~Microseconds{0};

/// The way out to the bus. What comes in, and that a frame was sent, reaches the owner as an event.
class CanPort {
 public:
  /// Hands a frame to the controller, which sends it when the bus is free, lower identifiers first.
  /// False if all its mailboxes are full: try again after the next frame was sent.
  [[nodiscard]] virtual bool send(const CanFrame& frame) = 0;
  /// State frames (0x181 to 0x1FF, 0x281 to 0x2FF) on other identifiers than these do not matter from now on, and a
  /// controller may keep them away. One that does not filter hands on all. Before the first call none matters.
  virtual void listen(std::span<const std::uint16_t> /*identifiers*/) {}
  /// Bus-off (ISO 11898-1, 6.13): the controller has given up after too many errors and has forgotten what it had to
  /// send. Asks it to come back, which takes 128 times 11 recessive bits. Controllers that do so by themselves ignore
  /// it.
  virtual void recover() {}

 protected:
  ~CanPort() = default;
};

}  // namespace proleg
