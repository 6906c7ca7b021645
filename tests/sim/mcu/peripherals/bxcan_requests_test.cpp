#include "sim/mcu/peripherals/bxcan_transmitter.hpp"

#include <gtest/gtest.h>

namespace proleg::sim {
namespace {

using Kind = BxCanRequests::Kind;

TEST(BxCanRequestsTest, ARequestIsPendingUntilTheBusHasReachedItsTime) {
  BxCanRequests requests;
  EXPECT_TRUE(requests.empty());
  EXPECT_EQ(requests.next_time(), never_on_bus);
  requests.add(100, Kind::transmit, 2);
  EXPECT_EQ(requests.next_time(), 100U);
  EXPECT_FALSE(requests.take_due(99));
  const auto request = requests.take_due(100);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->kind, Kind::transmit);
  EXPECT_EQ(request->value, 2U);
  EXPECT_TRUE(requests.empty());
}

TEST(BxCanRequestsTest, RequestsKeepTheirOrderAlsoIfALaterOneHasAnEarlierTime) {
  BxCanRequests requests;
  requests.add(100, Kind::transmit, 0);
  requests.add(50, Kind::abort, 0);
  EXPECT_EQ(requests.next_time(), 100U);
  EXPECT_FALSE(requests.take_due(50));
  EXPECT_EQ(requests.take_due(100)->kind, Kind::transmit);
  EXPECT_EQ(requests.next_time(), 100U);
  EXPECT_EQ(requests.take_due(100)->kind, Kind::abort);
}

TEST(BxCanRequestsTest, LaterRequestsWaitForAPostponedOne) {
  BxCanRequests requests;
  requests.add(100, Kind::control, 1);
  requests.add(110, Kind::transmit, 0);
  const auto control = requests.take_due(100);
  ASSERT_TRUE(control);
  requests.postpone(*control, 200);
  EXPECT_EQ(requests.next_time(), 200U);
  EXPECT_FALSE(requests.take_due(150));
  const auto postponed = requests.take_due(200);
  ASSERT_TRUE(postponed);
  EXPECT_EQ(postponed->kind, Kind::control);
  EXPECT_EQ(postponed->value, 1U);
  EXPECT_EQ(requests.take_due(200)->kind, Kind::transmit);
}

TEST(BxCanRequestsTest, ClearDropsAllRequests) {
  BxCanRequests requests;
  requests.add(100, Kind::transmit, 0);
  requests.clear();
  EXPECT_TRUE(requests.empty());
  EXPECT_FALSE(requests.take_due(never_on_bus));
}

}  // namespace
}  // namespace proleg::sim
