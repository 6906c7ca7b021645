// Programs that take part in a bus which this program has open.

#include "host/robot/shared_bus.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <deque>
#include <memory>
#include <thread>
#include <vector>

#include "host/transport/event_loop.hpp"
#include "host/transport/open_transport.hpp"

namespace proleg::host {
namespace {

CanFrame numbered(std::uint16_t number) {
  CanFrame frame;
  frame.identifier = 0x123;
  frame.length = 2;
  frame.data[0] = static_cast<std::uint8_t>(number & 0xFFU);
  frame.data[1] = static_cast<std::uint8_t>(number >> 8U);
  return frame;
}

/// A bus that carries frames when the test says so.
class HeldBus final : public Transport {
 public:
  HeldBus(boost::asio::io_context& context, TransportListener& listener) : context_(context), listener_(listener) {
    state_.is_connected = true;
  }
  [[nodiscard]] Microseconds now() const override { return steady_now(); }
  [[nodiscard]] bool send(const CanFrame& frame) override {
    if (!has_room) {
      return false;
    }
    waiting.push_back(frame);
    return true;
  }
  void run_until(Microseconds deadline) override { host::run_until(context_, deadline, false); }
  [[nodiscard]] const BusState& state() const override { return state_; }
  [[nodiscard]] Statistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "held"; }

  /// The oldest frame that waits is on the bus.
  void carry() {
    const CanFrame frame = waiting.front();
    waiting.pop_front();
    listener_.transmitted(now(), frame);
  }
  void lose() { waiting.pop_front(); }
  void receive(const CanFrame& frame) { listener_.received(now(), frame); }

  std::deque<CanFrame> waiting;
  bool has_room = true;

 private:
  boost::asio::io_context& context_;
  TransportListener& listener_;
  BusState state_;
};

/// A program at the other end of a socket.
class Program final : private TransportListener {
 public:
  Program(boost::asio::io_context& context, SharedBus& bus) {
    std::array<int, 2> ends{};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    bus.add(Descriptor(ends[0]));
    transport = open_transport(context, parse_bus_address("fd:" + std::to_string(ends[1])), *this);
  }
  std::unique_ptr<Transport> transport;
  std::vector<CanFrame> frames;

 private:
  void received(Microseconds /*time*/, const CanFrame& frame) override { frames.push_back(frame); }
  void transmitted(Microseconds /*time*/, const CanFrame& /*frame*/) override {}
};

class SharedBusTest : public testing::Test {
 protected:
  template <typename IsDone>
  [[nodiscard]] bool wait_for(IsDone&& is_done) {
    constexpr int most_looks = 5'000;
    for (int look = 0; look < most_looks && !is_done(); ++look) {
      context.restart();
      context.run_for(std::chrono::milliseconds(1));
    }
    return is_done();
  }

  boost::asio::io_context context;
  HeldBus* held = nullptr;
  BusConnection bus{[this](TransportListener& listener) {
    auto transport = std::make_unique<HeldBus>(context, listener);
    held = transport.get();
    return transport;
  }};
  SharedBus shared{context, bus};
  Program first{context, shared};
  Program second{context, shared};
};

TEST_F(SharedBusTest, GivesWhatTheBusBringsToAllPrograms) {
  held->receive(numbered(7));
  ASSERT_TRUE(wait_for([&] { return first.frames.size() + second.frames.size() == 2; }));
  EXPECT_EQ(first.frames, std::vector<CanFrame>{numbered(7)});
  EXPECT_EQ(second.frames, first.frames);
}

TEST_F(SharedBusTest, GivesAFrameOfAProgramToTheOthersWhenTheBusHasCarriedIt) {
  ASSERT_TRUE(first.transport->send(numbered(1)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 1; }));
  EXPECT_TRUE(second.frames.empty());
  held->carry();
  ASSERT_TRUE(wait_for([&] { return second.frames.size() == 1; }));
  EXPECT_TRUE(first.frames.empty()) << "a program does not receive its own frames";
}

TEST_F(SharedBusTest, GivesAFrameOfThisProgramToAllPrograms) {
  ASSERT_TRUE(bus.send(numbered(3)));
  held->carry();
  ASSERT_TRUE(wait_for([&] { return first.frames.size() + second.frames.size() == 2; }));
}

TEST_F(SharedBusTest, EqualFramesOfTwoProgramsComeToEachFromTheOther) {
  ASSERT_TRUE(first.transport->send(numbered(1)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 1; }));
  ASSERT_TRUE(second.transport->send(numbered(1)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 2; }));
  held->carry();
  held->carry();
  ASSERT_TRUE(wait_for([&] { return first.frames.size() == 1 && second.frames.size() == 1; }));
}

TEST_F(SharedBusTest, AFrameThatTheBusHasLostDoesNotHideALaterOne) {
  ASSERT_TRUE(first.transport->send(numbered(1)));
  ASSERT_TRUE(first.transport->send(numbered(2)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 2; }));
  held->lose();
  held->carry();
  ASSERT_TRUE(wait_for([&] { return second.frames.size() == 1; }));
  EXPECT_EQ(second.frames, std::vector<CanFrame>{numbered(2)});
  ASSERT_TRUE(second.transport->send(numbered(1)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 1; }));
  held->carry();
  ASSERT_TRUE(wait_for([&] { return first.frames.size() == 1; })) << "this one is of the second program";
}

TEST_F(SharedBusTest, ABusWithoutRoomRefusesAFrameAndGoesOn) {
  held->has_room = false;
  ASSERT_TRUE(first.transport->send(numbered(1)));
  ASSERT_TRUE(wait_for([&] { return first.transport->statistics().refused == 1; }));
  held->has_room = true;
  ASSERT_TRUE(first.transport->send(numbered(2)));
  ASSERT_TRUE(wait_for([&] { return held->waiting.size() == 1; }));
  held->carry();
  ASSERT_TRUE(wait_for([&] { return second.frames.size() == 1; }));
}

TEST_F(SharedBusTest, AProgramThatEndsLeavesTheOthersAlone) {
  EXPECT_EQ(shared.programs(), 2U);
  first.transport.reset();
  ASSERT_TRUE(wait_for([&] { return shared.programs() == 1; }));
  held->receive(numbered(9));
  ASSERT_TRUE(wait_for([&] { return second.frames.size() == 1; }));
}

}  // namespace
}  // namespace proleg::host
