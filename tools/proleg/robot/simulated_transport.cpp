#include "tools/proleg/robot/simulated_transport.hpp"

#include <algorithm>
#include <iostream>
#include <utility>

namespace proleg::tools {

SimulatedTransport::SimulatedTransport(const sim::Scenario& scenario, std::string address,
                                       host::TransportListener& listener)
    : address_(std::move(address)), listener_(listener), robot_(scenario, options()) {
  state_.is_connected = true;
  statistics_.connections = 1;
}

sim::LiveRobotOptions SimulatedTransport::options() {
  sim::LiveRobotOptions options;
  options.on_frame = [this](const sim::Transmission& transmission, bool is_own) {
    if (!is_own) {
      events_.push_back({transmission.end, transmission.frame, false});
    }
  };
  options.on_sent = [this](sim::BusTime time, const CanFrame& frame, std::uint32_t /*source*/) {
    events_.push_back({time, frame, true});
  };
  options.notice = [](const std::string& text) { std::cerr << "proleg: " << text << '\n'; };
  return options;
}

bool SimulatedTransport::send(const CanFrame& frame) {
  const bool is_taken = robot_.send(frame);
  statistics_.dropped_out += is_taken ? 0U : 1U;
  return is_taken;
}

void SimulatedTransport::run_until(Microseconds deadline) {
  const sim::BusTime end = std::max(sim::BusTime{deadline} * 1'000, robot_.now());
  while (events_.empty() && robot_.now() < end) {
    robot_.advance_to_frame(end);
  }
  hand_out();
}

void SimulatedTransport::hand_out() {
  for (const Event& event : std::exchange(events_, {})) {
    if (event.is_own) {
      ++statistics_.transmitted;
      listener_.transmitted(event.time / 1'000, event.frame);
    } else {
      ++statistics_.received;
      listener_.received(event.time / 1'000, event.frame);
    }
  }
}

}  // namespace proleg::tools
