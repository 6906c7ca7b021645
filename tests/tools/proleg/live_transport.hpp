#pragma once

// A simulated robot on virtual time as the bus of a BusAccess: what the subcommands do, without waiting for it.

#include "host/transport/transport.hpp"
#include "live_bus.hpp"

namespace proleg::test {

class LiveTransport final : public host::Transport, private host::BusUser {
 public:
  /// bus, listener: must outlive this.
  LiveTransport(LiveBus& bus, host::TransportListener& listener) : bus_(bus), listener_(listener) {
    state_.is_connected = true;
    bus_.attach(*this);
  }
  ~LiveTransport() override { bus_.detach(*this); }

  [[nodiscard]] Microseconds now() const override { return bus_.now(); }
  [[nodiscard]] bool send(const CanFrame& frame) override { return bus_.send(frame); }
  void run_until(Microseconds deadline) override {
    has_event_ = false;
    bus_.run_until(deadline, [this] { return has_event_; });
  }
  [[nodiscard]] const host::BusState& state() const override { return state_; }
  [[nodiscard]] host::Statistics statistics() const override { return statistics_; }
  [[nodiscard]] std::string description() const override { return "virtual time"; }

 private:
  void receive(Microseconds now, const CanFrame& frame) override {
    has_event_ = true;
    ++statistics_.received;
    listener_.received(now, frame);
  }
  void transmitted(Microseconds now, const CanFrame& frame) override {
    has_event_ = true;
    ++statistics_.transmitted;
    listener_.transmitted(now, frame);
  }

  LiveBus& bus_;
  host::TransportListener& listener_;
  host::BusState state_;
  host::Statistics statistics_;
  bool has_event_ = false;
};

}  // namespace proleg::test
