#pragma once

// A simulated robot in this process, as the bus of a host: time passes as fast as the computer simulates it.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/transport/transport.hpp"
#include "sim/live/live_robot.hpp"

namespace proleg::tools {

class SimulatedTransport final : public host::Transport {
 public:
  /// The modules are switched on. scenario, listener: must outlive this.
  SimulatedTransport(const sim::Scenario& scenario, std::string address, host::TransportListener& listener);

  [[nodiscard]] Microseconds now() const override { return robot_.now() / 1'000; }
  [[nodiscard]] bool send(const CanFrame& frame) override;
  void run_until(Microseconds deadline) override;
  [[nodiscard]] const host::BusState& state() const override { return state_; }
  [[nodiscard]] host::Statistics statistics() const override { return statistics_; }
  [[nodiscard]] std::string description() const override { return address_ + ", at full speed"; }

 private:
  struct Event {
    sim::BusTime time;
    CanFrame frame;
    bool is_own;
  };

  sim::LiveRobotOptions options();
  void hand_out();

  std::string address_;
  host::TransportListener& listener_;
  host::BusState state_;
  host::Statistics statistics_;
  std::vector<Event> events_;
  sim::LiveRobot robot_;
};

}  // namespace proleg::tools
