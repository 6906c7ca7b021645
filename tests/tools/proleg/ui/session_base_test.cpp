#include "tools/proleg/ui/session_base.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace proleg::tools {
namespace {

TEST(SessionRouter, EachSessionGetsItsOwn) {
  SessionRequests recordings;
  SessionRequests draft;
  SessionRequests meshes;
  SessionRequests gallery;
  SessionRequests algorithms;
  SessionRequests searches;
  SessionRequests sweeps;
  SessionRequests modules;
  SessionRequests remote;
  SessionRequests robot;
  SessionRouter router(recordings, draft, meshes, gallery, algorithms, searches, sweeps, modules, remote, robot);
  router.operate({1, "recording.list", nlohmann::json::object(), 1, "a test"});
  router.operate({2, "set", nlohmann::json::object(), 1, "a test"});
  router.operate({3, "remote.watch", nlohmann::json::object(), 1, "a test"});
  router.operate({4, "draft.undo", nlohmann::json::object(), 1, "a test"});
  router.operate({5, "world.add", nlohmann::json::object(), 1, "a test"});
  router.operate({6, "gallery.look", nlohmann::json::object(), 1, "a test"});
  router.operate({7, "algorithm.build", nlohmann::json::object(), 1, "a test"});
  router.operate({8, "mesh.begin", nlohmann::json::object(), 1, "a test"});
  router.operate({9, "search.open", nlohmann::json::object(), 1, "a test"});
  router.operate({10, "modules.scan", nlohmann::json::object(), 1, "a test"});
  router.holder_changed(true, false);
  router.operate({11, "sweep.open", nlohmann::json::object(), 1, "a test"});
  EXPECT_EQ(sweeps.take_operation()->request, 11U);
  EXPECT_EQ(modules.take_operation()->request, 10U);
  EXPECT_EQ(searches.take_operation()->request, 9U);
  EXPECT_EQ(meshes.take_operation()->request, 8U);
  EXPECT_EQ(algorithms.take_operation()->request, 7U);
  EXPECT_EQ(recordings.take_operation()->request, 1U);
  EXPECT_EQ(robot.take_operation()->request, 2U);
  EXPECT_EQ(remote.take_operation()->request, 3U);
  EXPECT_EQ(draft.take_operation()->request, 4U);
  EXPECT_EQ(draft.take_operation()->request, 5U);
  EXPECT_EQ(gallery.take_operation()->request, 6U);
  EXPECT_FALSE(draft.take_operation());
  EXPECT_FALSE(robot.take_operation());
  EXPECT_FALSE(remote.take_operation());
  EXPECT_FALSE(recordings.take_operation());
  EXPECT_TRUE(robot.take_holder().is_there);
  EXPECT_TRUE(remote.take_holder().is_there);
  EXPECT_TRUE(modules.take_holder().is_there);
  router.stop({6, "a test"});
  std::deque<host::OperationRequest> outdated;
  EXPECT_TRUE(recordings.take_stops(outdated).empty());
  EXPECT_EQ(robot.take_stops(outdated).size(), 1U);
  EXPECT_EQ(remote.take_stops(outdated).size(), 1U);
  EXPECT_EQ(modules.take_stops(outdated).size(), 1U);
}

TEST(Argument, IsTakenOnlyIfItsTypeHasIt) {
  const auto whole = [](const nlohmann::json& value) {
    return argument<std::uint32_t>({{"number", value}}, "number", "a whole number");
  };
  EXPECT_EQ(whole(4294967295U), 4294967295U);
  EXPECT_EQ(whole(nullptr), std::nullopt);
  for (const nlohmann::json& value : {nlohmann::json(-1), nlohmann::json(4294967296), nlohmann::json(1e99),
                                      nlohmann::json(2.0), nlohmann::json("2"), nlohmann::json::array({2})}) {
    EXPECT_THROW(static_cast<void>(whole(value)), InputError) << value;
    const nlohmann::json list{{"numbers", nlohmann::json::array({1, value})}};
    EXPECT_THROW(static_cast<void>(argument<std::vector<std::uint32_t>>(list, "numbers", "whole numbers")), InputError);
  }
  EXPECT_EQ(argument<double>({{"number", 1e99}}, "number", "a number"), 1e99);
}

host::OperationRequest operation(host::RequestId request) {
  return {request, "run", nlohmann::json::object(), 1, "desk"};
}

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
  std::deque<host::OperationRequest> outdated;
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
  constexpr host::RequestId sent = 10 * host::max_pending_stops;
  for (host::RequestId request = 1; request <= sent; ++request) {
    requests.stop({request, "desk"});
  }
  std::deque<host::OperationRequest> outdated;
  const std::vector<SessionRequests::Stop> stops = requests.take_stops(outdated);
  ASSERT_EQ(stops.size(), host::max_pending_stops);
  EXPECT_EQ(stops.back().request, sent);
}

TEST(SessionRequests, WithoutAStopNothingIsOutdated) {
  SessionRequests requests;
  requests.operate(operation(1));
  std::deque<host::OperationRequest> outdated;
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
}  // namespace proleg::tools
