#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::host {

/// A state machine of the host on a bus, without a clock of its own: it receives frames and times by calls, and sends
/// frames through a CanPort. A BusConnection drives it on a real bus, a test on virtual time.
class BusUser {
 public:
  virtual void receive(Microseconds now, const CanFrame& frame) = 0;
  /// The transport took a frame of any user of this host. The function sends nothing itself.
  virtual void requested(Microseconds /*now*/, const CanFrame& /*frame*/) {}
  /// A frame of any user of this host is on the bus: the port may have room for another one.
  virtual void transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) {}
  /// To be called at next_deadline() or later.
  virtual void poll(Microseconds /*now*/) {}
  [[nodiscard]] virtual Microseconds next_deadline() const { return never; }

 protected:
  ~BusUser() = default;
};

/// Makes a state machine of shared/computer/master a user of a bus.
template <typename Machine>
class MachineUser final : public BusUser {
 public:
  /// machine: must outlive this.
  explicit MachineUser(Machine& machine) : machine_(machine) {}

  void receive(Microseconds now, const CanFrame& frame) override { machine_.receive(now, frame); }
  void transmitted(Microseconds now, const CanFrame& frame) override { machine_.transmitted(now, frame); }
  void poll(Microseconds now) override { machine_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const override { return machine_.next_deadline(); }

 private:
  Machine& machine_;
};

}  // namespace proleg::host
