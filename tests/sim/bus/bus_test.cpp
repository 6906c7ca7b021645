#include "sim/bus/bus.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "frames.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime bit = 1'000;

struct Event {
  std::string node;
  bool sent;
  BusTime time;
  CanFrame frame;

  friend bool operator==(const Event&, const Event&) = default;
};

void PrintTo(const Event& event, std::ostream* stream) {
  *stream << event.node << (event.sent ? " sent " : " received ") << std::hex << event.frame.identifier << std::dec
          << " of " << unsigned{event.frame.length} << " bytes at " << event.time;
}

/// Logs what it receives and sends, and may react.
class Node final : public BusListener {
 public:
  Node(Bus& bus, std::string node_name, std::vector<Event>& log)
      : name(std::move(node_name)), controller(bus.attach(*this)), log_(&log) {}

  void received(BusTime time, const CanFrame& frame) override { note(false, time, frame); }
  void transmitted(BusTime time, const CanFrame& frame) override { note(true, time, frame); }

  std::string name;
  Controller& controller;
  std::function<void(const Event&)> reaction;

 private:
  void note(bool sent, BusTime time, const CanFrame& frame) {
    const Event event{name, sent, time, frame};
    log_->push_back(event);
    if (reaction) {
      reaction(event);
    }
  }

  std::vector<Event>* log_;
};

BusTime duration(const CanFrame& frame) { return frame_bits(frame) * bit; }

class BusOfThree : public testing::Test {
 protected:
  /// The frames that ended, in order, as the third node or its sender saw them.
  [[nodiscard]] std::vector<CanFrame> frames() const {
    std::vector<CanFrame> result;
    for (const Event& event : log) {
      if (event.node == "c") {
        result.push_back(event.frame);
      }
    }
    return result;
  }

  Bus bus;
  std::vector<Event> log;
  Node a{bus, "a", log};
  Node b{bus, "b", log};
  Node c{bus, "c", log};
  const CanFrame low = frame_of(0x080, {0x2D});
  const CanFrame middle = frame_of(0x183, {0x8E, 0xE3, 0x38, 0x4E, 0x72, 0x1C, 0x83, 0x2C});
  const CanFrame high = frame_of(0x703, {0x05});
};

TEST_F(BusOfThree, AFrameIsReportedAtItsLastBitToTheSenderThenInTheOrderOfAttachment) {
  bus.advance_to(5'000);
  ASSERT_TRUE(b.controller.send(middle));
  const BusTime end = 5'000 + duration(middle);
  EXPECT_EQ(bus.next_event(), end);
  bus.advance_to(end - 1);
  EXPECT_TRUE(log.empty());
  EXPECT_EQ(bus.next_event(), end);
  bus.advance_to(end);
  const std::vector<Event> expected{{"b", true, end, middle}, {"a", false, end, middle}, {"c", false, end, middle}};
  EXPECT_EQ(log, expected);
  EXPECT_EQ(bus.next_event(), never_on_bus);
}

TEST_F(BusOfThree, TheNextFrameStartsThreeBitsAfterTheLastOne) {
  ASSERT_TRUE(a.controller.send(low));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(1'000'000);
  ASSERT_EQ(frames(), (std::vector{low, high}));
  EXPECT_EQ(log.back().time, duration(low) + 3 * bit + duration(high));
}

TEST_F(BusOfThree, TheLowestIdentifierWinsInEveryOrderOfCalls) {
  ASSERT_TRUE(c.controller.send(high));
  bus.advance_to(0);  // time does not move on: all of the instant take part
  ASSERT_TRUE(a.controller.send(middle));
  bus.advance_to(0);
  ASSERT_TRUE(b.controller.send(low));
  EXPECT_EQ(bus.next_event(), duration(low));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{low, middle, high}));
}

TEST_F(BusOfThree, AFrameOnTheWireIsNotInterrupted) {
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(1);
  ASSERT_TRUE(b.controller.send(low));
  EXPECT_EQ(bus.next_event(), duration(high));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{high, low}));
}

TEST_F(BusOfThree, AFrameRequestedInTheInterframeSpaceTakesPartAtItsEnd) {
  ASSERT_TRUE(a.controller.send(middle));
  ASSERT_TRUE(a.controller.send(high));
  const BusTime free = duration(middle) + 3 * bit;
  bus.advance_to(free);  // at its very end
  ASSERT_TRUE(b.controller.send(low));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{middle, low, high}));
}

TEST_F(BusOfThree, AfterTheInterframeSpaceAnIdleBusStartsAtOnce) {
  ASSERT_TRUE(a.controller.send(middle));
  const BusTime later = duration(middle) + 4 * bit + 123;
  bus.advance_to(later);
  ASSERT_TRUE(b.controller.send(low));
  EXPECT_EQ(bus.next_event(), later + duration(low));
}

TEST_F(BusOfThree, AnAnswerGivenAtTheEndOfAFrameTakesPartInTheNextArbitration) {
  a.reaction = [this](const Event& event) {
    if (event.frame == middle) {
      EXPECT_TRUE(a.controller.send(low));
    }
  };
  ASSERT_TRUE(b.controller.send(middle));
  ASSERT_TRUE(b.controller.send(high));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{middle, low, high}));
}

TEST_F(BusOfThree, AControllerHasThreeMailboxesAndSendsTheLowestIdentifierFirst) {
  const CanFrame high_again = frame_of(0x703, {0x7F});
  ASSERT_TRUE(a.controller.send(high));
  ASSERT_TRUE(a.controller.send(high_again));
  ASSERT_TRUE(a.controller.send(low));
  EXPECT_EQ(a.controller.free_mailboxes(), 0U);
  EXPECT_FALSE(a.controller.send(middle));
  bus.advance_to(1);
  EXPECT_FALSE(a.controller.send(middle)) << "the frame on the wire keeps its mailbox";
  a.reaction = [this](const Event& event) {
    if (event.frame == low) {
      EXPECT_TRUE(a.controller.send(middle));
      EXPECT_FALSE(a.controller.send(middle));
    }
  };
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{low, middle, high, high_again}));
  EXPECT_EQ(a.controller.free_mailboxes(), 3U);
}

TEST_F(BusOfThree, AbortWithdrawsWhatIsNotOnTheWire) {
  ASSERT_TRUE(a.controller.send(middle));
  bus.advance_to(1);
  ASSERT_TRUE(a.controller.send(low));
  ASSERT_TRUE(a.controller.send(high));
  a.controller.abort_all();
  EXPECT_EQ(a.controller.free_mailboxes(), 2U);
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), std::vector{middle});
  EXPECT_EQ(log.front(), (Event{"a", true, duration(middle), middle}));
  EXPECT_EQ(bus.next_event(), never_on_bus);
}

TEST_F(BusOfThree, AnAbortedRequestLeavesTheBusIdle) {
  ASSERT_TRUE(a.controller.send(low));
  a.controller.abort_all();
  EXPECT_EQ(bus.next_event(), never_on_bus);
  bus.advance_to(10'000);
  ASSERT_TRUE(b.controller.send(middle));
  EXPECT_EQ(bus.next_event(), 10'000 + duration(middle));
}

TEST_F(BusOfThree, ANodeWithoutPowerNeitherSendsNorReceives) {
  c.controller.switch_off();
  EXPECT_FALSE(c.controller.is_on());
  EXPECT_FALSE(c.controller.send(low));
  ASSERT_TRUE(a.controller.send(middle));
  bus.advance_to(1'000'000);
  EXPECT_TRUE(frames().empty());
  c.controller.switch_on();
  ASSERT_TRUE(a.controller.send(high));
  ASSERT_TRUE(c.controller.send(low));
  bus.advance_to(2'000'000);
  EXPECT_EQ(frames(), (std::vector{low, high}));
}

TEST_F(BusOfThree, ANodeThatGetsPowerDuringAFrameReceivesOnlyTheNextOne) {
  c.controller.switch_off();
  ASSERT_TRUE(a.controller.send(middle));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(10 * bit);
  c.controller.switch_on();
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), std::vector{high});
}

TEST_F(BusOfThree, ANodeThatLosesPowerDuringItsFrameGetsNoReportOfItsEnd) {
  ASSERT_TRUE(c.controller.send(low));
  ASSERT_TRUE(c.controller.send(high));
  bus.advance_to(10 * bit);
  c.controller.switch_off();
  c.controller.switch_on();  // restarted at once
  EXPECT_EQ(c.controller.free_mailboxes(), 2U);
  bus.advance_to(1'000'000);
  EXPECT_EQ(log, (std::vector<Event>{{"a", false, duration(low), low}, {"b", false, duration(low), low}}));
  EXPECT_EQ(c.controller.free_mailboxes(), 3U);
}

TEST_F(BusOfThree, FramesThatAreEqualInEveryBitBecomeOneTransmission) {
  ASSERT_TRUE(c.controller.send(low));
  ASSERT_TRUE(a.controller.send(low));
  bus.advance_to(1'000'000);
  const BusTime end = duration(low);
  EXPECT_EQ(log, (std::vector<Event>{{"a", true, end, low}, {"c", true, end, low}, {"b", false, end, low}}));
  EXPECT_EQ(bus.statistics().frames, 1U);
  EXPECT_EQ(bus.statistics().collisions, 0U);
}

TEST_F(BusOfThree, OneIdentifierWithDifferentContentsIsReportedAndTheDominantBitsWin) {
  const CanFrame one = frame_of(0x183, {0x10, 0x01});
  const CanFrame other = frame_of(0x183, {0x10, 0x81});
  const CanFrame shorter = frame_of(0x183, {0xFF});
  std::vector<std::pair<CanFrame, CanFrame>> collisions;
  bus.on_collision(
      [&](BusTime, const CanFrame& winner, const CanFrame& loser) { collisions.emplace_back(winner, loser); });
  ASSERT_TRUE(a.controller.send(other));
  ASSERT_TRUE(b.controller.send(one));
  ASSERT_TRUE(c.controller.send(shorter));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), (std::vector{shorter, one, other}));
  EXPECT_EQ(collisions, (std::vector<std::pair<CanFrame, CanFrame>>{{shorter, other}, {shorter, one}, {one, other}}));
  EXPECT_EQ(bus.statistics().collisions, 3U);
}

TEST_F(BusOfThree, ALostFrameMissesOneReceiverOnly) {
  bus.set_loss_rule([this](const CanFrame& frame, std::size_t receiver) {
    return frame == middle && receiver == b.controller.index();
  });
  ASSERT_TRUE(a.controller.send(middle));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(1'000'000);
  unsigned received_by_b = 0;
  for (const Event& event : log) {
    received_by_b += event.node == "b" ? 1U : 0U;
  }
  EXPECT_EQ(received_by_b, 1U);
  EXPECT_EQ(frames(), (std::vector{middle, high}));
  EXPECT_EQ(bus.statistics().losses, 1U);
}

TEST_F(BusOfThree, LoadIsThePartOfTheTimeTakenByFramesAndInterframeSpaces) {
  const BusTime taken = duration(middle) + 3 * bit;
  ASSERT_TRUE(a.controller.send(middle));
  bus.advance_to(taken / 2);
  EXPECT_EQ(bus.statistics().load(), 1.0);
  EXPECT_EQ(bus.statistics().frames, 0U);
  bus.advance_to(4 * taken);
  EXPECT_EQ(bus.statistics().busy, taken);
  EXPECT_EQ(bus.statistics().load(), 0.25);
  bus.start_statistics();
  bus.advance_to(5 * taken);
  EXPECT_EQ(bus.statistics().frames, 0U);
  EXPECT_EQ(bus.statistics().busy, 0U);
  EXPECT_EQ(bus.statistics().period, taken);
  EXPECT_EQ(Bus().statistics().load(), 0.0);
}

TEST_F(BusOfThree, TheTraceSeesEveryFrameWithItsStartAndSender) {
  std::vector<Transmission> trace;
  bus.set_frame_listener([&](const Transmission& transmission) { trace.push_back(transmission); });
  ASSERT_TRUE(b.controller.send(middle));
  bus.advance_to(1'000'000);
  ASSERT_EQ(trace.size(), 1U);
  EXPECT_EQ(trace[0].start, 0U);
  EXPECT_EQ(trace[0].end, duration(middle));
  EXPECT_EQ(trace[0].frame, middle);
  EXPECT_EQ(trace[0].sender, b.controller.index());
}

TEST_F(BusOfThree, BytesBeyondTheLengthAreNotSent) {
  CanFrame frame = low;
  frame.data[5] = 0xFF;
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(1'000'000);
  EXPECT_EQ(frames(), std::vector{low});
}

TEST_F(BusOfThree, AFrameThatCanDoesNotHaveIsAnErrorOfTheCaller) {
  CanFrame frame = frame_of(0x800);
  EXPECT_THROW(static_cast<void>(a.controller.send(frame)), std::invalid_argument);
  frame = low;
  frame.length = 9;
  EXPECT_THROW(static_cast<void>(a.controller.send(frame)), std::invalid_argument);
  EXPECT_EQ(a.controller.free_mailboxes(), 3U);
}

TEST_F(BusOfThree, AListenerMustNotAdvanceTheBus) {
  a.reaction = [this](const Event&) { bus.advance_to(bus.now() + 1); };
  ASSERT_TRUE(b.controller.send(low));
  EXPECT_THROW(bus.advance_to(1'000'000), std::logic_error);
}

TEST_F(BusOfThree, TimeDoesNotRunBackwards) {
  bus.advance_to(5'000);
  bus.advance_to(4'000);
  EXPECT_EQ(bus.now(), 5'000U);
}

TEST(BusOfAnyRate, DurationsFollowFromTheBitRate) {
  Bus bus(125'000);
  std::vector<Event> log;
  Node a(bus, "a", log);
  const CanFrame frame = frame_of(0x555, {1, 2, 3});
  ASSERT_TRUE(a.controller.send(frame));
  EXPECT_EQ(bus.next_event(), frame_bits(frame) * 8'000U);
}

TEST(BusOfAnyRate, ClassicalCanHasOneBitToOneMegabitASecond) {
  EXPECT_THROW(Bus(0), std::invalid_argument);
  EXPECT_THROW(Bus(1'000'001), std::invalid_argument);
}

}  // namespace
}  // namespace proleg::sim
