#include "host/server/robot_session.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace proleg::host {
namespace {

OperationRequest operation(RequestId request) { return {request, "run", nlohmann::json::object(), 1, "desk"}; }

TEST(SessionRequests, AreTakenInTheirOrder) {
  SessionRequests requests;
  EXPECT_FALSE(requests.are_there());
  requests.operate(operation(1));
  requests.operate(operation(2));
  EXPECT_TRUE(requests.are_there());
  EXPECT_EQ(requests.take_operation()->request, 1U);
  EXPECT_EQ(requests.take_operation()->request, 2U);
  EXPECT_FALSE(requests.take_operation());
  EXPECT_FALSE(requests.are_there());
}

TEST(SessionRequests, AStopOvertakesWhatCameBeforeItAndWhatComesWhileItWaits) {
  SessionRequests requests;
  requests.operate(operation(1));
  requests.stop({2, "desk"});
  requests.stop({3, "POST /stop"});
  requests.operate(operation(4));
  EXPECT_TRUE(requests.interrupts());
  EXPECT_FALSE(requests.take_operation());
  std::deque<OperationRequest> outdated;
  const std::vector<SessionRequests::Stop> stops = requests.take_stops(outdated);
  ASSERT_EQ(stops.size(), 2U);
  EXPECT_EQ(stops[0].by, "desk");
  EXPECT_EQ(stops[1].request, 3U);
  ASSERT_EQ(outdated.size(), 2U);
  EXPECT_EQ(outdated[1].request, 4U);
  EXPECT_FALSE(requests.interrupts());
  requests.operate(operation(5));
  EXPECT_EQ(requests.take_operation()->request, 5U);
}

TEST(SessionRequests, KeepTheNewestOfManyStops) {
  SessionRequests requests;
  constexpr RequestId sent = 10 * max_pending_stops;
  for (RequestId request = 1; request <= sent; ++request) {
    requests.stop({request, "desk"});
  }
  std::deque<OperationRequest> outdated;
  const std::vector<SessionRequests::Stop> stops = requests.take_stops(outdated);
  ASSERT_EQ(stops.size(), max_pending_stops);
  EXPECT_EQ(stops.back().request, sent);
}

TEST(SessionRequests, WithoutAStopNothingIsOutdated) {
  SessionRequests requests;
  requests.operate(operation(1));
  std::deque<OperationRequest> outdated;
  EXPECT_TRUE(requests.take_stops(outdated).empty());
  EXPECT_TRUE(outdated.empty());
  EXPECT_TRUE(requests.take_operation());
}

TEST(SessionRequests, SaysWhoDrives) {
  SessionRequests requests;
  EXPECT_FALSE(requests.take_holder().is_there);
  requests.holder_changed(true, false);
  EXPECT_TRUE(requests.are_there());
  EXPECT_TRUE(requests.take_holder().is_there);
  EXPECT_FALSE(requests.are_there());
  requests.holder_changed(true, true);
  EXPECT_TRUE(requests.take_holder().is_away);
}

TEST(SessionRequests, WakeASessionThatWaits) {
  for (int round = 0; round < 100; ++round) {
    SessionRequests requests;
    std::thread viewer([&] { round % 2 == 0 ? requests.stop({1, "desk"}) : requests.end(); });
    requests.wait();
    EXPECT_TRUE(requests.interrupts());
    EXPECT_EQ(requests.ends(), round % 2 == 1);
    viewer.join();
  }
}

}  // namespace
}  // namespace proleg::host
