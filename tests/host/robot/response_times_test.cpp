#include "host/robot/response_times.hpp"

#include <gtest/gtest.h>

#include "shared/canopen/messages.hpp"

namespace proleg::host {
namespace {

/// A request to node 3 that opens a transaction: object 0x2004:1 of docs/objects.md.
CanFrame opening(std::uint8_t transaction) { return {0x603, 8, {0x2B, 0x04, 0x20, 0x01, transaction, 0, 0, 0}}; }
CanFrame commit(std::uint16_t transaction, std::uint32_t tick) {
  return canopen::encode(canopen::CommitMessage{transaction, tick, 1});
}

TEST(ChangeTimes, OfAPlannedChangeBeginWithItsFirstRequest) {
  ChangeTimes times;
  times.requested(1'000, opening(1));
  times.requested(1'300, opening(1));
  times.requested(3'500, commit(1, 700));
  times.requested(3'700, commit(1, 700));
  EXPECT_EQ(times.acknowledged_us().count(), 1U);
  EXPECT_EQ(times.acknowledged_us().median(), 2'500U);
  EXPECT_EQ(times.ticks_to_effect().count(), 0U) << "its tick was planned";
}

TEST(ChangeTimes, OfATypedChangeBeginWhenItIsAccepted) {
  ChangeTimes times;
  times.accepted(0, 500, 100);
  times.requested(1'000, opening(1));
  times.requested(3'500, commit(1, 123));
  EXPECT_EQ(times.acknowledged_us().median(), 3'000U);
  EXPECT_EQ(times.ticks_to_effect().median(), 23U);
}

TEST(ChangeTimes, ADroppedChangeDoesNotCountAndAnEarlierOneDoesNotCountAgain) {
  ChangeTimes times;
  times.requested(0, opening(1));
  times.requested(100, opening(2));
  times.requested(300, commit(2, 50));
  times.requested(400, opening(2));  // for a module that has restarted
  times.requested(500, commit(2, 50));
  EXPECT_EQ(times.acknowledged_us().count(), 1U);
  EXPECT_EQ(times.acknowledged_us().median(), 200U);
}

// Requests to node 3 for its device type and its error register, the answer, and the abort of the host (CiA 301).
constexpr CanFrame request{0x603, 8, {0x40, 0x00, 0x10, 0x00}};
constexpr CanFrame other_request{0x603, 8, {0x40, 0x01, 0x10, 0x00}};
constexpr CanFrame answer{0x583, 8, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}};
constexpr CanFrame abort_of_host{0x603, 8, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}};

TEST(AnswerTimes, AreFromTheRequestToTheAnswerOfThatNode) {
  AnswerTimes times;
  times.requested(100, request);
  times.receive(150, CanFrame{0x584, 8, {0x43}});
  EXPECT_EQ(times.microseconds().count(), 0U);
  times.receive(400, answer);
  times.receive(500, answer);
  EXPECT_EQ(times.microseconds().count(), 1U);
  EXPECT_EQ(times.microseconds().median(), 300U);
}

TEST(AnswerTimes, ARepeatedRequestCountsFromItsFirstTime) {
  AnswerTimes times;
  times.requested(0, request);
  times.requested(500, request);
  times.receive(900, answer);
  EXPECT_EQ(times.microseconds().median(), 900U);
}

TEST(AnswerTimes, ARequestWithoutAnAnswerDoesNotCount) {
  AnswerTimes times;
  times.requested(0, request);
  times.requested(500, other_request);
  times.receive(600, answer);
  EXPECT_EQ(times.microseconds().median(), 100U);
  times.requested(700, request);
  times.requested(800, abort_of_host);
  times.receive(900, answer);
  EXPECT_EQ(times.microseconds().count(), 1U);
}

}  // namespace
}  // namespace proleg::host
