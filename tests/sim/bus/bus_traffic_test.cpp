// Random traffic of many nodes, compared with a list of all requests. Properties of ISO 11898-1: one frame at a
// time, the lowest identifier that waits at an arbitration, no idling while something waits; and of a bus without
// errors: every accepted frame is sent once, frames of one identifier in the order of their requests.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "frames.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime bit = 1'000;
constexpr BusTime end_of_requests = 200'000'000;

struct Request {
  BusTime time;
  CanFrame frame;
};

class TrafficNode final : public BusListener {
 public:
  TrafficNode(Bus& bus, std::uint16_t number, std::mt19937_64& random)
      : controller(bus.attach(*this)), bus_(&bus), number_(number), random_(&random) {}

  void received(BusTime time, const CanFrame& frame) override {
    EXPECT_EQ(time, bus_->now());
    arrived.push_back(frame);
    if ((*random_)() % 64 == 0 && time < end_of_requests) {
      request();
    }
  }
  void transmitted(BusTime time, const CanFrame& frame) override {
    EXPECT_EQ(time, bus_->now());
    sent.push_back(frame);
    if ((*random_)() % 4 == 0 && time < end_of_requests) {
      request();
    }
  }

  /// A frame with an identifier that no other node has.
  void request() {
    const auto level = static_cast<std::uint16_t>((*random_)() % 4);
    const CanFrame frame = random_frame(static_cast<std::uint16_t>(level * 0x200 + number_),
                                        static_cast<std::uint8_t>((*random_)() % 9), *random_);
    const bool room = controller.free_mailboxes() > 0;
    EXPECT_EQ(controller.send(frame), room);
    if (room) {
      waiting.push_back({bus_->now(), frame});
      ++accepted;
    }
  }

  Controller& controller;
  std::deque<Request> waiting;  ///< accepted, transmission not begun
  std::size_t accepted = 0;
  std::vector<CanFrame> sent;
  std::vector<CanFrame> arrived;

 private:
  Bus* bus_;
  std::uint16_t number_;
  std::mt19937_64* random_;
};

class Traffic : public testing::TestWithParam<unsigned> {};

TEST_P(Traffic, KeepsTheRulesOfTheBus) {
  const unsigned seed = GetParam();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  Bus bus;
  std::vector<std::unique_ptr<TrafficNode>> nodes;
  const std::size_t node_count = 2 + random() % 30;
  for (std::size_t i = 0; i < node_count; ++i) {
    nodes.push_back(std::make_unique<TrafficNode>(bus, static_cast<std::uint16_t>(i + 1), random));
  }

  BusTime free_at = 0;
  BusTime busy = 0;
  std::vector<CanFrame> order;
  bus.set_frame_listener([&](const Transmission& transmission) {
    EXPECT_EQ(transmission.end - transmission.start, frame_bits(transmission.frame) * bit);
    // The expected winner at the instant of arbitration, from the requests alone.
    BusTime first_request = never_on_bus;
    std::uint16_t lowest = 0xFFFF;
    for (const auto& node : nodes) {
      for (const Request& request : node->waiting) {
        first_request = std::min(first_request, request.time);
        if (request.time <= transmission.start) {
          lowest = std::min(lowest, request.frame.identifier);
        }
      }
    }
    EXPECT_EQ(transmission.start, std::max(free_at, first_request));
    EXPECT_EQ(transmission.frame.identifier, lowest);
    std::deque<Request>& waiting = nodes[transmission.sender]->waiting;
    const auto request = std::ranges::find(waiting, lowest, [](const Request& r) { return r.frame.identifier; });
    ASSERT_NE(request, waiting.end());
    EXPECT_EQ(request->frame, transmission.frame);
    waiting.erase(request);
    free_at = transmission.end + 3 * bit;
    busy += free_at - transmission.start;
    order.push_back(transmission.frame);
  });

  BusTime next_request = 0;
  const BusTime mean_pause = 20'000 + random() % 400'000;  // from overload to nearly idle
  while (next_request < end_of_requests || bus.next_event() != never_on_bus) {
    const BusTime time = std::min(bus.next_event(), next_request);
    bus.advance_to(time);
    if (time == next_request) {
      for (std::uint64_t n = 1 + random() % 4; n-- > 0;) {
        nodes[random() % node_count]->request();
      }
      next_request += random() % (2 * mean_pause);
      next_request = next_request < end_of_requests ? next_request : never_on_bus;
    }
  }
  bus.advance_to(free_at);

  EXPECT_GT(order.size(), 300U);
  EXPECT_EQ(bus.statistics().frames, order.size());
  EXPECT_EQ(bus.statistics().busy, busy);
  EXPECT_EQ(bus.statistics().collisions, 0U);
  std::size_t accepted = 0;
  for (const auto& node : nodes) {
    EXPECT_TRUE(node->waiting.empty());
    EXPECT_EQ(node->sent.size(), node->accepted);
    EXPECT_EQ(node->arrived.size() + node->sent.size(), order.size());
    EXPECT_EQ(node->controller.free_mailboxes(), Controller::mailbox_count);
    accepted += node->accepted;
  }
  EXPECT_EQ(accepted, order.size());
}

INSTANTIATE_TEST_SUITE_P(Seeds, Traffic, testing::Range(1U, 41U));

/// Two nodes that both use every identifier: frames collide, and still each is sent once.
TEST(TrafficWithCollisions, LosesAndRepeatsNothing) {
  constexpr unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  class Counter final : public BusListener {
   public:
    void received(BusTime /*time*/, const CanFrame& /*frame*/) override { ++arrived; }
    void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override { ++sent; }
    std::size_t arrived = 0;
    std::size_t sent = 0;
  };
  Bus bus;
  std::array<Counter, 2> counters;
  const std::array<Controller*, 2> controllers{&bus.attach(counters[0]), &bus.attach(counters[1])};
  std::array<std::size_t, 2> accepted{};
  for (BusTime time = 0; time < 200'000'000; time += 40'000) {
    bus.advance_to(time);
    for (std::size_t i = 0; i < 2; ++i) {
      const CanFrame frame =
          frame_of(static_cast<std::uint16_t>(random() % 4), {static_cast<std::uint8_t>(random() % 3)});
      accepted[i] += controllers[i]->send(frame) ? 1U : 0U;
    }
  }
  bus.advance_to(never_on_bus - 1);
  EXPECT_EQ(counters[0].sent, accepted[0]);
  EXPECT_EQ(counters[1].sent, accepted[1]);
  const std::size_t merged = accepted[0] + accepted[1] - bus.statistics().frames;
  EXPECT_EQ(counters[0].arrived + merged, counters[1].sent);
  EXPECT_EQ(counters[1].arrived + merged, counters[0].sent);
  EXPECT_GT(merged, 10U);
  EXPECT_GT(bus.statistics().collisions, 10U);
}

}  // namespace
}  // namespace proleg::sim
