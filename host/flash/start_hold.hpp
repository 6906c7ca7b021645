#pragma once

// Holds modules in their bootloaders whose supply is switched on: while this object is attached to a bus, it repeats
// the request for which a bootloader listens after power on, before it starts its program (docs/flashing.md). Modules
// whose program runs ignore the request. It is the only way to a module whose program answers nothing.

#include "host/robot/bus_user.hpp"
#include "shared/broadcast/transfer_frame.hpp"

namespace proleg::host {

class StartHold final : public BusUser {
 public:
  /// port: must outlive this.
  explicit StartHold(CanPort& port) : port_(port) {}
  StartHold(const StartHold&) = delete;
  StartHold& operator=(const StartHold&) = delete;

  /// Whether a node has acknowledged a request: else the supply of all is off, or they are deaf.
  [[nodiscard]] bool is_heard() const { return is_heard_; }

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void transmitted(Microseconds /*now*/, const CanFrame& frame) override {
    is_heard_ = is_heard_ || broadcast::is_enter_request(frame, broadcast::every_serial);
  }
  /// While no module has power no node acknowledges a frame. Then the port has no room, and later requests follow the
  /// one that waits.
  void poll(Microseconds now) override {
    if (now >= next_) {
      static_cast<void>(port_.send(broadcast::enter_frame(broadcast::every_serial)));
      next_ = now + broadcast::hold_period_us;
    }
  }
  [[nodiscard]] Microseconds next_deadline() const override { return next_; }

 private:
  CanPort& port_;
  Microseconds next_ = 0;
  bool is_heard_ = false;
};

}  // namespace proleg::host
