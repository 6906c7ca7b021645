#pragma once

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

 protected:
  ~CanPort() = default;
};

}  // namespace proleg
