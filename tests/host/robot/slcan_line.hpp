#pragma once

// The way between a host and a simulated robot: the client of slcan, a line, and an adapter, on virtual time.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "host/transport/slcan_client.hpp"
#include "shared/can/slcan_adapter.hpp"
#include "sim/live/live_robot.hpp"

namespace proleg::test {

class SlcanLine final : private host::SlcanClientListener, private CanPort {
 public:
  struct Event {
    Microseconds time;
    CanFrame frame;
    bool is_own;
  };

  explicit SlcanLine(sim::LiveRobot& robot) : robot_(robot), client_(*this, {}), adapter_(buffer_, *this) {
    client_.start(now());
    exchange();
    EXPECT_EQ(client_.state(), host::SlcanClient::State::open) << client_.error();
  }

  /// A frame of the host.
  [[nodiscard]] bool send_by_host(const CanFrame& frame) {
    const bool is_taken = client_.send(frame);
    exchange();
    return is_taken;
  }
  /// A frame that the adapter has received from the bus.
  void received_from_bus(const CanFrame& frame) {
    adapter_.received(now(), frame);
    exchange();
  }
  /// Does what is due at the present time of the robot.
  void poll() {
    if (client_.next_deadline() <= now()) {
      client_.poll(now());
    }
    exchange();
  }
  /// The same while the host is suspended.
  void poll_robot() { exchange(); }
  [[nodiscard]] Microseconds next_event() const {
    Microseconds next = client_.next_deadline();
    for (const std::deque<Text>* way : {&to_robot_.texts, &to_host_.texts}) {
      next = way->empty() ? next : std::min(next, way->front().time);
    }
    return next;
  }
  [[nodiscard]] std::vector<Event> take_events() { return std::exchange(events_, {}); }

  // What happens to the line.
  void cut_to_robot() { to_robot_.is_cut = true; }
  void cut_from_robot() { to_host_.is_cut = true; }
  /// What is sent from now on arrives later, in both directions.
  void delay(Microseconds duration) { to_robot_.delay = to_host_.delay = duration; }
  /// The program of the host stands still: it neither sends nor reads.
  void suspend_host(bool is_suspended) { is_suspended_ = is_suspended; }

 private:
  struct Text {
    Microseconds time;
    std::string characters;
  };
  struct Way {
    bool is_cut = false;
    Microseconds delay = 0;
    std::deque<Text> texts = {};

    void put(Microseconds now, std::string characters) {
      if (!is_cut && !characters.empty()) {
        texts.push_back({now + delay, std::move(characters)});
      }
    }
    [[nodiscard]] std::string take(Microseconds now) {
      std::string taken;
      for (; !texts.empty() && texts.front().time <= now; texts.pop_front()) {
        taken += texts.front().characters;
      }
      return taken;
    }
  };

  [[nodiscard]] Microseconds now() const { return robot_.now() / 1'000; }

  /// Moves characters until nothing more is due.
  void exchange() {
    for (bool is_any = true; is_any;) {
      if (!is_suspended_) {
        to_robot_.put(now(), client_.take(now(), 4'096));
      }
      const std::string to_adapter = to_robot_.take(now());
      adapter_.input(to_adapter);
      std::array<char, 4'096> output{};
      to_host_.put(now(), std::string(output.data(), adapter_.take(output)));
      const std::string to_client = is_suspended_ ? std::string() : to_host_.take(now());
      client_.input(now(), to_client);
      is_any = !to_adapter.empty() || !to_client.empty() || (!is_suspended_ && client_.has_output());
    }
  }

  // SlcanClientListener
  void received(Microseconds time, const CanFrame& frame) override { events_.push_back({time, frame, false}); }
  void transmitted(Microseconds time, const CanFrame& frame) override { events_.push_back({time, frame, true}); }
  void status_received(const CanStatus& /*status*/) override {}
  void errors_received(CanErrors /*errors*/) override {}
  // CanPort: the bus, for the adapter
  [[nodiscard]] bool send(const CanFrame& frame) override { return robot_.send(frame); }

  sim::LiveRobot& robot_;
  host::SlcanClient client_;
  std::vector<char> buffer_ = std::vector<char>(65'536);
  SlcanAdapter adapter_;
  Way to_robot_;
  Way to_host_;
  bool is_suspended_ = false;
  std::vector<Event> events_;
};

}  // namespace proleg::test
