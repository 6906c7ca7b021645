#include "host/robot/answer_times.hpp"

#include <gtest/gtest.h>

namespace proleg::host {
namespace {

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
