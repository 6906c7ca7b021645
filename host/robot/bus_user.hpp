#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::host {

/// A state machine of the host on a bus, without a clock of its own: frames and times come in with the calls, frames go
/// out through a CanPort. A BusConnection moves it on a real bus, a test on virtual time.
class BusUser {
 public:
  virtual void receive(Microseconds now, const CanFrame& frame) = 0;
  /// The transport took a frame of this host, of any of its users. Sends nothing itself.
  virtual void requested(Microseconds /*now*/, const CanFrame& /*frame*/) {}
  /// A frame of this host, of any of its users, is on the bus: there may be room for another one.
  virtual void transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) {}
  /// To be called at next_deadline() or later.
  virtual void poll(Microseconds /*now*/) {}
  [[nodiscard]] virtual Microseconds next_deadline() const { return never; }

 protected:
  ~BusUser() = default;
};

}  // namespace proleg::host
