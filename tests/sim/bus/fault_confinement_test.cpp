// Errors on the bus, against the rules of ISO 11898-1 (fault confinement, error and interframe frames). The tests count
// errors independently, from the rules alone.

#include "sim/bus/controller.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frames.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime bit = 1'000;
constexpr BusTime flag_and_delimiter = (6 + 8) * bit;
constexpr BusTime intermission = 3 * bit;

class Node final : public BusListener {
 public:
  explicit Node(Bus& bus) : controller(bus.attach(*this)) {}

  void received(BusTime time, const CanFrame& frame) override { arrived.emplace_back(time, frame); }
  void transmitted(BusTime time, const CanFrame& frame) override { sent.emplace_back(time, frame); }
  void error_seen(BusTime time, bool was_sending) override { errors.emplace_back(time, was_sending); }
  void error_state_changed(BusTime time) override { states.emplace_back(time, controller.error_state()); }
  void joined(BusTime time) override { joins.push_back(time); }

  Controller& controller;
  std::vector<std::pair<BusTime, CanFrame>> arrived;
  std::vector<std::pair<BusTime, CanFrame>> sent;
  std::vector<std::pair<BusTime, bool>> errors;
  std::vector<std::pair<BusTime, ErrorState>> states;
  std::vector<BusTime> joins;
};

BusTime duration(const CanFrame& frame) { return frame_bits(frame) * bit; }
/// A destroyed frame up to the bit after which the error flag begins: its CRC delimiter. Behind that come ACK slot and
/// delimiter and 7 bits of end of frame.
BusTime until_error(const CanFrame& frame) { return duration(frame) - (1 + 1 + 7) * bit; }
BusTime until_missing_acknowledgement(const CanFrame& frame) { return duration(frame) - (1 + 7) * bit; }

class FaultConfinement : public testing::Test {
 protected:
  void destroy_next(std::uint64_t count) {
    bus.set_error_rule([left = count](const CanFrame&, std::uint64_t) mutable { return left > 0 && left-- > 0; });
  }

  Bus bus;
  Node a{bus};
  Node b{bus};
  Node c{bus};
  const CanFrame low = frame_of(0x080, {0x2D});
  const CanFrame frame = frame_of(0x183, {0x8E, 0xE3, 0x38, 0x4E, 0x72, 0x1C, 0x83, 0x2C});
  const CanFrame high = frame_of(0x703, {0x05});
};

TEST_F(FaultConfinement, ADestroyedFrameEndsInAnErrorFrameAndIsSentAgainOnce) {
  destroy_next(1);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(10'000'000);
  const BusTime error = until_error(frame) + flag_and_delimiter;
  const BusTime end = error + intermission + duration(frame);
  using Errors = std::vector<std::pair<BusTime, bool>>;
  EXPECT_EQ(a.errors, (Errors{{error, true}}));
  EXPECT_EQ(b.errors, (Errors{{error, false}}));
  using Frames = std::vector<std::pair<BusTime, CanFrame>>;
  EXPECT_EQ(a.sent, (Frames{{end, frame}}));
  EXPECT_EQ(b.arrived, a.sent);
  EXPECT_EQ(c.arrived, a.sent);
  EXPECT_EQ(a.controller.free_mailboxes(), Controller::mailbox_count);
  EXPECT_EQ(bus.statistics().frames, 1U);
  EXPECT_EQ(bus.statistics().errors, 1U);
  EXPECT_EQ(bus.statistics().losses, 0U);
  EXPECT_EQ(bus.statistics().busy, end + intermission);
}

TEST_F(FaultConfinement, EveryNodeCountsAnErrorAndSuccessLowersTheCount) {
  destroy_next(1);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(until_error(frame) + flag_and_delimiter);
  EXPECT_EQ(a.controller.transmit_errors(), 8U);
  EXPECT_EQ(a.controller.receive_errors(), 0U);
  EXPECT_EQ(a.controller.last_error(), CanError::bit_recessive);
  EXPECT_EQ(b.controller.transmit_errors(), 0U);
  EXPECT_EQ(b.controller.receive_errors(), 1U);
  EXPECT_EQ(b.controller.last_error(), CanError::form);
  bus.advance_to(1'000'000);
  EXPECT_EQ(a.controller.transmit_errors(), 7U);
  EXPECT_EQ(b.controller.receive_errors(), 0U);
  EXPECT_EQ(a.controller.last_error(), CanError::none);
  EXPECT_EQ(b.controller.last_error(), CanError::none);
}

TEST_F(FaultConfinement, AnotherFrameMayWinTheArbitrationAfterAnError) {
  destroy_next(1);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(10 * bit);
  ASSERT_TRUE(b.controller.send(low));
  bus.advance_to(10'000'000);
  ASSERT_EQ(c.arrived.size(), 2U);
  EXPECT_EQ(c.arrived[0].second, low);
  EXPECT_EQ(c.arrived[1].second, frame);
}

TEST_F(FaultConfinement, After16ErrorsInARowASenderIsPassiveAndAfter32InBusOff) {
  bus.set_error_rule([](const CanFrame&, std::uint64_t) { return true; });
  ASSERT_TRUE(a.controller.send(frame));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(100'000'000);
  EXPECT_EQ(bus.statistics().errors, 32U);
  EXPECT_EQ(a.errors.size(), 32U);
  ASSERT_EQ(a.states.size(), 2U);
  EXPECT_EQ(a.states[0], std::make_pair(a.errors[15].first, ErrorState::passive));
  EXPECT_EQ(a.states[1], std::make_pair(a.errors[31].first, ErrorState::bus_off));
  EXPECT_EQ(b.controller.receive_errors(), 32U);
  EXPECT_TRUE(b.states.empty());
  EXPECT_EQ(bus.next_event(), never_on_bus) << "there is nothing left to send";

  EXPECT_EQ(a.controller.free_mailboxes(), Controller::mailbox_count);
  EXPECT_FALSE(a.controller.send(frame));
  EXPECT_TRUE(a.sent.empty());
  bus.set_error_rule({});
  ASSERT_TRUE(b.controller.send(low));
  bus.advance_to(200'000'000);
  EXPECT_TRUE(a.arrived.empty());
  EXPECT_EQ(c.arrived.size(), 1U);
}

TEST_F(FaultConfinement, AReceiverBecomesPassiveAbove127AndActiveWithTheNextFrame) {
  bool destroy = true;
  bus.set_error_rule([&](const CanFrame&, std::uint64_t) { return destroy; });
  while (c.controller.error_state() == ErrorState::active) {
    ASSERT_LT(c.errors.size(), 1'000U);
    a.controller.switch_off();
    a.controller.switch_on();  // and so never in bus-off
    ASSERT_TRUE(a.controller.send(frame));
    const std::size_t before = c.errors.size();
    while (c.errors.size() == before) {
      bus.advance_to(bus.next_event());
    }
    EXPECT_EQ(c.controller.receive_errors(), before + 1);
  }
  EXPECT_EQ(c.errors.size(), 128U);
  destroy = false;
  bus.advance_to(bus.now() + 1'000'000);
  EXPECT_EQ(c.controller.error_state(), ErrorState::active);
  EXPECT_GE(c.controller.receive_errors(), 119U);
  EXPECT_LE(c.controller.receive_errors(), 127U);
  ASSERT_EQ(c.states.size(), 2U);
  EXPECT_EQ(c.states[1].first, c.arrived.front().first);
}

TEST_F(FaultConfinement, BusOffIsLeftAfter128Times11RecessiveBits) {
  destroy_next(32);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(100'000'000);
  ASSERT_EQ(a.controller.error_state(), ErrorState::bus_off);
  bus.advance_to(200'000'000);
  EXPECT_EQ(a.controller.error_state(), ErrorState::bus_off) << "not without recover()";
  a.controller.recover();
  a.controller.recover();
  EXPECT_EQ(bus.next_event(), 200'000'000 + 128 * 11 * bit);
  bus.advance_to(200'000'000 + 128 * 11 * bit - 1);
  EXPECT_EQ(a.controller.error_state(), ErrorState::bus_off);
  bus.advance_to(200'000'000 + 128 * 11 * bit);
  EXPECT_EQ(a.controller.error_state(), ErrorState::active);
  EXPECT_EQ(a.controller.transmit_errors(), 0U);
  EXPECT_EQ(a.controller.receive_errors(), 0U);
  EXPECT_EQ(a.states.back(), std::make_pair(bus.now(), ErrorState::active));
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(300'000'000);
  EXPECT_EQ(b.arrived.size(), 1U);
}

TEST_F(FaultConfinement, OnABusThatIsNeverIdleEachFrameCountsAsOneSequenceOf11RecessiveBits) {
  destroy_next(32);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(100'000'000);
  ASSERT_EQ(a.controller.error_state(), ErrorState::bus_off);
  while (b.controller.send(low)) {
  }
  bus.advance_to(100'000'000 + 20 * bit);
  a.controller.recover();  // in the middle of a frame
  while (a.controller.error_state() == ErrorState::bus_off) {
    ASSERT_LT(b.sent.size(), 1'000U);
    bus.advance_to(bus.next_event());
    static_cast<void>(b.controller.send(low));
  }
  // ACK delimiter, end of frame and intermission are 11 bits.
  EXPECT_EQ(b.sent.size(), 128U);
  EXPECT_EQ(a.states.back().first, b.sent.back().first + intermission);
}

TEST_F(FaultConfinement, RecoveryOnAHalfIdleBusCountsTheRunsOfRecessiveBits) {
  constexpr unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  destroy_next(32);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(100'000'000);
  BusTime recessive_since = bus.now();
  unsigned sequences = 0;
  BusTime expected = 0;
  bus.set_frame_listener([&](const Transmission& transmission) {
    const auto bits = static_cast<unsigned>((transmission.start - recessive_since) / bit);
    if (sequences < 128 && sequences + bits / 11 >= 128) {
      expected = recessive_since + (128 - sequences) * 11 * bit;
    }
    sequences += bits / 11;
    recessive_since = transmission.end - 8 * bit;
  });
  a.controller.recover();
  while (a.controller.error_state() == ErrorState::bus_off || expected == 0) {
    bus.advance_to(bus.now() + random() % 200'000);
    static_cast<void>(b.controller.send(random_frame(0x100, static_cast<std::uint8_t>(random() % 9), random)));
  }
  EXPECT_EQ(a.states.back(), std::make_pair(expected, ErrorState::active));
}

TEST_F(FaultConfinement, RecoveryEndsWithPower) {
  destroy_next(32);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(100'000'000);
  a.controller.recover();
  a.controller.switch_off();
  EXPECT_EQ(bus.next_event(), never_on_bus);
  a.controller.switch_on();
  EXPECT_EQ(a.controller.error_state(), ErrorState::active);
  EXPECT_EQ(a.controller.transmit_errors(), 0U);
  ASSERT_TRUE(a.controller.send(frame));
}

TEST_F(FaultConfinement, AnActiveSenderMayContinueAfterIntermissionAPassiveOneWaits8BitsMore) {
  destroy_next(17);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(10'000'000);
  ASSERT_EQ(a.errors.size(), 17U);
  const BusTime attempt = until_error(frame) + flag_and_delimiter;
  for (std::size_t i = 1; i < a.errors.size(); ++i) {
    const BusTime pause = a.errors[i].first - a.errors[i - 1].first - attempt;
    EXPECT_EQ(pause, i < 16 ? intermission : intermission + 8 * bit) << "after error " << i;
  }
  ASSERT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(a.sent[0].first, a.errors.back().first + intermission + 8 * bit + duration(frame));

  // Also after a frame that went well (TEC 135).
  a.sent.clear();
  ASSERT_TRUE(a.controller.send(low));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(20'000'000);
  ASSERT_EQ(a.sent.size(), 2U);
  EXPECT_EQ(a.sent[1].first - a.sent[0].first, intermission + 8 * bit + duration(high));
}

TEST_F(FaultConfinement, WhileAPassiveSenderWaitsOthersMayStartWithAnyIdentifier) {
  destroy_next(16);
  ASSERT_TRUE(a.controller.send(low));
  while (a.errors.size() < 16) {
    bus.advance_to(bus.next_event());
  }
  ASSERT_EQ(a.controller.error_state(), ErrorState::passive);
  ASSERT_TRUE(b.controller.send(high));
  const BusTime error = bus.now();
  bus.advance_to(error + 1'000'000);
  ASSERT_EQ(c.arrived.size(), 2U);
  EXPECT_EQ(c.arrived[0], std::make_pair(error + intermission + duration(high), high));
  EXPECT_EQ(c.arrived[1], std::make_pair(c.arrived[0].first + intermission + duration(low), low))
      << "a node that has received a frame meanwhile waits no longer";
}

TEST_F(FaultConfinement, WhileAPassiveSenderWaitsAnIdleBusIsOpenToOthersAtOnce) {
  destroy_next(16);
  ASSERT_TRUE(a.controller.send(low));
  while (a.errors.size() < 16) {
    bus.advance_to(bus.next_event());
  }
  const BusTime start = bus.now() + intermission + 4 * bit;
  bus.advance_to(start);
  ASSERT_TRUE(b.controller.send(high));
  bus.advance_to(start + 1'000'000);
  EXPECT_EQ(c.arrived[0], std::make_pair(start + duration(high), high));
}

TEST_F(FaultConfinement, AnUnpluggedNodeGetsNothingAndComesBackPassiveWithItsFrames) {
  c.controller.unplug();
  ASSERT_TRUE(a.controller.send(frame));
  ASSERT_TRUE(c.controller.send(high));
  bus.advance_to(10'000'000);
  EXPECT_EQ(b.arrived.size(), 1U);
  EXPECT_TRUE(c.arrived.empty());
  EXPECT_TRUE(c.sent.empty());
  c.controller.plug_in();
  EXPECT_EQ(c.controller.error_state(), ErrorState::passive) << "nobody acknowledged its frame";
  bus.advance_to(20'000'000);
  EXPECT_EQ(c.sent.size(), 1U);
  EXPECT_EQ(a.arrived.size(), 1U);
  ASSERT_FALSE(c.states.empty());
}

TEST_F(FaultConfinement, AnUnpluggedNodeThatHadNothingToSayComesBackActive) {
  c.controller.unplug();
  bus.advance_to(10'000'000);
  c.controller.plug_in();
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(20'000'000);
  EXPECT_EQ(c.controller.error_state(), ErrorState::active);
  EXPECT_EQ(c.arrived.size(), 1U);
}

TEST_F(FaultConfinement, TheFrameOfANodeThatIsUnpluggedIsDestroyedAndSentWhenItIsBack) {
  ASSERT_TRUE(c.controller.send(frame));
  bus.advance_to(duration(frame) / 2);
  c.controller.unplug();
  bus.advance_to(10'000'000);
  EXPECT_TRUE(a.arrived.empty());
  EXPECT_EQ(a.errors.size(), 1U);
  c.controller.plug_in();
  bus.advance_to(20'000'000);
  EXPECT_EQ(a.arrived.size(), 1U);
  EXPECT_EQ(c.sent.size(), 1U);
}

TEST_F(FaultConfinement, ADominantBusPutsItsSenderInBusOffAndMakesTheOthersPassive) {
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(duration(frame) / 2);
  bus.hold_dominant(true);
  EXPECT_EQ(a.controller.error_state(), ErrorState::bus_off);
  EXPECT_EQ(b.controller.error_state(), ErrorState::passive);
  ASSERT_TRUE(b.controller.send(high));
  a.controller.recover();
  bus.advance_to(50'000'000);
  EXPECT_TRUE(b.sent.empty()) << "nobody can send on a dominant bus";
  EXPECT_EQ(a.controller.error_state(), ErrorState::bus_off) << "there are no recessive bits";
  bus.hold_dominant(false);
  bus.advance_to(100'000'000);
  ASSERT_EQ(b.sent.size(), 1U);
  EXPECT_EQ(b.sent[0].first, 50'000'000 + 11 * bit + duration(high));
  EXPECT_EQ(a.controller.error_state(), ErrorState::active) << "after 128 times 11 recessive bits";
}

TEST_F(FaultConfinement, ADelayedFrameArrivesLaterInTheOrderOfTime) {
  bus.set_delay_rule([](const CanFrame& given, std::size_t receiver) -> BusTime {
    return receiver == 1 && given.identifier == 0x080 ? 5'000'000 : 0;
  });
  ASSERT_TRUE(a.controller.send(low));
  ASSERT_TRUE(a.controller.send(frame));
  while (bus.next_event() != never_on_bus) {
    bus.advance_to(bus.next_event());
  }
  ASSERT_EQ(b.arrived.size(), 2U);
  EXPECT_EQ(b.arrived[0].second, frame);
  EXPECT_EQ(b.arrived[1].second, low);
  EXPECT_EQ(b.arrived[1].first, duration(low) + 5'000'000);
  ASSERT_EQ(c.arrived.size(), 2U);
  EXPECT_EQ(c.arrived[0].second, low);
}

TEST_F(FaultConfinement, ADelayedFrameDoesNotReachANodeThatIsOffByThen) {
  bus.set_delay_rule([](const CanFrame&, std::size_t receiver) -> BusTime { return receiver == 1 ? 1'000'000 : 0; });
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(500'000);
  b.controller.switch_off();
  bus.advance_to(10'000'000);
  EXPECT_TRUE(b.arrived.empty());
  EXPECT_EQ(c.arrived.size(), 1U);
}

TEST(LoneNode, BecomesPassiveForLackOfAcknowledgementButNeverBusOff) {
  Bus bus;
  Node alone(bus);
  const CanFrame frame = frame_of(0x183, {1, 2, 3});
  ASSERT_TRUE(alone.controller.send(frame));
  bus.advance_to(1'000'000'000);
  EXPECT_TRUE(alone.sent.empty());
  EXPECT_EQ(alone.controller.error_state(), ErrorState::passive);
  EXPECT_EQ(alone.controller.transmit_errors(), 128U);
  EXPECT_EQ(alone.controller.last_error(), CanError::acknowledgement);
  EXPECT_EQ(alone.states.size(), 1U);
  EXPECT_EQ(alone.errors[0].first, until_missing_acknowledgement(frame) + flag_and_delimiter);
  EXPECT_EQ(alone.errors[15].first, alone.states[0].first);
  const BusTime period = until_missing_acknowledgement(frame) + flag_and_delimiter + intermission + 8 * bit;
  EXPECT_EQ(alone.errors[101].first - alone.errors[100].first, period);
  EXPECT_EQ(bus.statistics().frames, 0U);

  Node other(bus);
  bus.advance_to(bus.now() + 2 * period);
  ASSERT_EQ(alone.sent.size(), 1U);
  EXPECT_EQ(other.arrived, alone.sent);
  EXPECT_EQ(alone.controller.transmit_errors(), 127U);
  EXPECT_EQ(alone.controller.error_state(), ErrorState::active);
}

TEST_F(FaultConfinement, NodesWithoutPowerInBusOffOrSilentDoNotAcknowledge) {
  b.controller.switch_off();
  c.controller.set_role(Controller::Role::silent);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(1'000'000);
  EXPECT_TRUE(a.sent.empty());
  EXPECT_TRUE(c.arrived.empty());
  EXPECT_GT(a.errors.size(), 5U);
  b.controller.switch_on();
  bus.advance_to(2'000'000);
  EXPECT_EQ(a.sent.size(), 1U);
  EXPECT_EQ(c.arrived.size(), 1U) << "a silent node receives";
  ASSERT_TRUE(c.controller.send(low)) << "but keeps the frame in its mailbox";
  bus.advance_to(3'000'000);
  EXPECT_TRUE(c.sent.empty());
  c.controller.set_role(Controller::Role::normal);
  bus.advance_to(4'000'000);
  EXPECT_EQ(c.sent.size(), 1U);
}

TEST_F(FaultConfinement, ALoopingNodeNeedsNoAcknowledgementAndReceivesNothing) {
  b.controller.switch_off();
  c.controller.switch_off();
  a.controller.set_role(Controller::Role::loop_back);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(1'000'000);
  EXPECT_EQ(a.sent.size(), 1U);
  b.controller.switch_on();
  ASSERT_TRUE(b.controller.send(low));
  bus.advance_to(2'000'000);
  EXPECT_TRUE(a.arrived.empty());
  EXPECT_TRUE(b.sent.empty());
}

TEST_F(FaultConfinement, AWithdrawnFrameThatMeetsAnErrorIsNotSentAgain) {
  destroy_next(1);
  ASSERT_TRUE(a.controller.send(1, frame));
  EXPECT_FALSE(a.controller.send(1, low));
  bus.advance_to(10 * bit);
  EXPECT_FALSE(a.controller.abort(1));
  bus.advance_to(1'000'000);
  EXPECT_TRUE(a.sent.empty());
  EXPECT_EQ(a.errors.size(), 1U);
  EXPECT_EQ(a.controller.free_mailboxes(), Controller::mailbox_count);

  ASSERT_TRUE(a.controller.send(2, frame));
  EXPECT_TRUE(a.controller.abort(2));
  bus.advance_to(2'000'000);
  EXPECT_TRUE(a.sent.empty());
}

TEST_F(FaultConfinement, AOneShotFrameIsTriedOnce) {
  destroy_next(1);
  a.controller.set_one_shot(true);
  a.controller.watch(true);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(1'000'000);
  EXPECT_TRUE(a.sent.empty());
  EXPECT_EQ(a.controller.free_mailboxes(), Controller::mailbox_count);

  ASSERT_TRUE(a.controller.send(frame));
  ASSERT_TRUE(b.controller.send(low));
  bus.advance_to(2'000'000);
  EXPECT_TRUE(a.sent.empty()) << "the arbitration was lost";
  EXPECT_EQ(c.arrived.size(), 1U);
  ASSERT_TRUE(a.controller.send(frame));
  bus.advance_to(3'000'000);
  EXPECT_EQ(a.sent.size(), 1U);
}

TEST_F(FaultConfinement, TheOrderOfMailboxesCanBeChosen) {
  const CanFrame low_too = frame_of(0x080, {0x2E});
  const auto order_of = [&](Controller::Order order) {
    c.arrived.clear();
    a.controller.set_order(order);
    EXPECT_TRUE(a.controller.send(2, high));
    EXPECT_TRUE(a.controller.send(1, low));
    EXPECT_TRUE(a.controller.send(0, low_too));
    bus.advance_to(bus.now() + 1'000'000);
    std::vector<CanFrame> result;
    for (const auto& [time, arrived] : c.arrived) {
      result.push_back(arrived);
    }
    return result;
  };
  EXPECT_EQ(order_of(Controller::Order::identifier_then_request), (std::vector{low, low_too, high}));
  EXPECT_EQ(order_of(Controller::Order::identifier_then_mailbox), (std::vector{low_too, low, high}));
  EXPECT_EQ(order_of(Controller::Order::request), (std::vector{high, low, low_too}));
}

TEST_F(FaultConfinement, JoiningTakes11RecessiveBits) {
  c.controller.switch_off();
  bus.advance_to(5'000);
  c.controller.join();
  EXPECT_FALSE(c.controller.is_on());
  EXPECT_FALSE(c.controller.send(low));
  EXPECT_EQ(bus.next_event(), 5'000 + 11 * bit);
  bus.advance_to(100'000);
  EXPECT_EQ(c.joins, std::vector<BusTime>{5'000 + 11 * bit});
  EXPECT_TRUE(c.controller.is_on());

  // On a busy bus: at the end of the intermission after the frame, and the node receives the next frame.
  c.controller.switch_off();
  ASSERT_TRUE(a.controller.send(frame));
  ASSERT_TRUE(a.controller.send(high));
  bus.advance_to(100'000 + 20 * bit);
  c.controller.join();
  bus.advance_to(1'000'000);
  ASSERT_EQ(c.joins.size(), 2U);
  EXPECT_EQ(c.joins[1], 100'000 + duration(frame) + intermission);
  ASSERT_EQ(c.arrived.size(), 1U);
  EXPECT_EQ(c.arrived[0].second, high);
}

TEST_F(FaultConfinement, WithRealBitErrorsAnIdentifierSharedByTwoEndsInBusOffOfBoth) {
  bus.set_collision_rule(Bus::CollisionRule::bit_error);
  unsigned collisions = 0;
  bus.on_collision([&](BusTime, const CanFrame&, const CanFrame&) { ++collisions; });
  const CanFrame one = frame_of(0x183, {0x10, 0x01});
  const CanFrame other = frame_of(0x183, {0x10, 0x81});
  ASSERT_TRUE(a.controller.send(one));
  ASSERT_TRUE(b.controller.send(other));
  bus.advance_to(1);
  const BusTime error = bus.next_event();
  EXPECT_EQ(error, (first_different_bit(one, other) + 1) * bit + flag_and_delimiter);
  bus.advance_to(100'000'000);
  EXPECT_EQ(collisions, 32U);
  EXPECT_EQ(bus.statistics().errors, 32U);
  EXPECT_EQ(a.controller.error_state(), ErrorState::bus_off);
  EXPECT_EQ(b.controller.error_state(), ErrorState::bus_off);
  EXPECT_EQ(c.controller.receive_errors(), 32U);
  EXPECT_TRUE(c.arrived.empty());
}

TEST_F(FaultConfinement, ErrorCountersFollowTheRulesUnderRandomErrors) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    Bus noisy;
    std::vector<std::unique_ptr<Node>> nodes;
    for (unsigned i = 0; i < 4; ++i) {
      nodes.push_back(std::make_unique<Node>(noisy));
    }
    // Rules of ISO 11898-1, 12.1.4.2, for errors that all nodes see in one bit.
    struct Counters {
      unsigned transmit = 0;
      unsigned receive = 0;
      bool is_bus_off = false;
    };
    std::vector<Counters> expected(nodes.size());
    std::vector<std::size_t> errors_before(nodes.size());
    std::vector<std::size_t> sent_before(nodes.size());
    const unsigned percent = 20 + 5 * static_cast<unsigned>(seed % 10);
    noisy.set_error_rule([&](const CanFrame&, std::uint64_t) { return random() % 100 < percent; });
    for (unsigned step = 0; step < 3'000; ++step) {
      const std::size_t chosen = random() % nodes.size();
      static_cast<void>(nodes[chosen]->controller.send(
          frame_of(static_cast<std::uint16_t>(0x100 + chosen), {static_cast<std::uint8_t>(random())})));
      if (random() % 50 == 0) {
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          if (expected[i].is_bus_off) {
            nodes[i]->controller.switch_off();
            nodes[i]->controller.switch_on();
            expected[i] = {};
          }
        }
      }
      noisy.advance_to(noisy.now() + 1);
      if (noisy.next_event() == never_on_bus) {
        continue;
      }
      noisy.advance_to(noisy.next_event());
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        Counters& node = expected[i];
        Node& seen = *nodes[i];
        if (seen.errors.size() > errors_before[i]) {
          const bool sending = seen.errors.back().second;
          const bool alone = seen.controller.last_error() == CanError::acknowledgement;
          if (!sending) {
            node.receive += node.receive <= 127 ? 1 : 0;
          } else if (!alone || node.transmit <= 127) {
            node.transmit += 8;
          }
          node.is_bus_off = node.transmit > 255;
        } else if (seen.sent.size() > sent_before[i]) {
          node.transmit -= node.transmit > 0 ? 1 : 0;
        } else if (!seen.arrived.empty() && seen.arrived.back().first == noisy.now()) {
          node.receive = node.receive > 127 ? 127 : node.receive - (node.receive > 0 ? 1 : 0);
        }
        errors_before[i] = seen.errors.size();
        sent_before[i] = seen.sent.size();
        ASSERT_EQ(seen.controller.transmit_errors(), node.transmit) << "node " << i << " in step " << step;
        ASSERT_EQ(seen.controller.receive_errors(), node.receive) << "node " << i << " in step " << step;
        const ErrorState state = node.transmit > 255                         ? ErrorState::bus_off
                                 : node.transmit > 127 || node.receive > 127 ? ErrorState::passive
                                                                             : ErrorState::active;
        ASSERT_EQ(seen.controller.error_state(), state);
      }
    }
    EXPECT_GT(noisy.statistics().errors, 100U);
  }
}

class NoisyBus : public testing::TestWithParam<unsigned> {};

TEST_P(NoisyBus, EveryFrameArrivesOnceAndThoseOfAnIdentifierInTheirOrder) {
  const unsigned seed = GetParam();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  Bus bus;
  std::vector<std::unique_ptr<Node>> nodes;
  const std::size_t count = 2 + random() % 10;
  for (std::size_t i = 0; i < count; ++i) {
    nodes.push_back(std::make_unique<Node>(bus));
  }
  const unsigned percent = static_cast<unsigned>(random() % 11);  // no node comes near bus-off
  bus.set_error_rule([&](const CanFrame&, std::uint64_t) { return random() % 100 < percent; });
  std::map<std::uint16_t, std::vector<CanFrame>> accepted;
  std::size_t total = 0;
  for (BusTime time = 0; time < 400'000'000; time += random() % 400'000) {
    bus.advance_to(time);
    const std::size_t sender = random() % count;
    const auto identifier = static_cast<std::uint16_t>(random() % 4 * 0x200 + sender);
    const CanFrame frame = random_frame(identifier, static_cast<std::uint8_t>(random() % 9), random);
    if (nodes[sender]->controller.send(frame)) {
      accepted[identifier].push_back(frame);
      ++total;
    }
  }
  bus.advance_to(500'000'000);
  for (std::size_t i = 0; i < count; ++i) {
    std::map<std::uint16_t, std::vector<CanFrame>> seen;
    std::size_t frames = 0;
    for (const auto* list : {&nodes[i]->sent, &nodes[i]->arrived}) {
      for (const auto& [time, frame] : *list) {
        seen[frame.identifier].push_back(frame);
        ++frames;
      }
    }
    EXPECT_EQ(seen, accepted);
    EXPECT_EQ(frames, total);
  }
  EXPECT_EQ(bus.statistics().frames, total);
  EXPECT_EQ(bus.statistics().losses, 0U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, NoisyBus, testing::Range(1U, 31U));

TEST(FirstDifferentBit, IsWhereTheLevelsOnTheWireDiffer) {
  // SOF, 11 bits of identifier, RTR, IDE, r0 and three bits of DLC. Five zeros at their end cause a stuff bit.
  EXPECT_EQ(first_different_bit(frame_of(0x555, {0xAA}), frame_of(0x555, {0x2A})), 1U + 11U + 3U + 4U + 1U);
  EXPECT_EQ(first_different_bit(frame_of(0x555, {0xAA}), frame_of(0x555, {0xAB})), 1U + 11U + 3U + 4U + 1U + 7U);
  // Length 0 or 8: the first of the four bits of DLC.
  EXPECT_EQ(first_different_bit(frame_of(0x555), frame_of(0x555, {1, 2, 3, 4, 5, 6, 7, 8})), 15U);
  const CanFrame same = frame_of(0x123, {1, 2, 3});
  EXPECT_EQ(first_different_bit(same, same), frame_bits(same));
}

}  // namespace
}  // namespace proleg::sim
