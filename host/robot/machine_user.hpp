#pragma once

#include "host/robot/bus_user.hpp"

namespace proleg::host {

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
