#include "host/server/control_lease.hpp"

#include <gtest/gtest.h>

namespace proleg::host {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr ClientId anna = 1;
constexpr ClientId ben = 2;
constexpr ClientId carl = 3;

class Lease : public testing::Test {
 protected:
  void anna_takes() {
    lease.take(now, anna, "Anna", 1);
    ASSERT_EQ(results(), "1:1 ok");
  }
  /// The holder gives a sign of life every 250 ms.
  void pass(ServerTime duration, ClientId holder) {
    for (const ServerTime end = now + duration; now < end;) {
      now += std::min<ServerTime>(250ms, end - now);
      lease.beat(now, holder, 10);
    }
  }
  /// "CLIENT:OPERATION ok" or "CLIENT:OPERATION error", separated by "; ".
  std::string results() {
    std::string text;
    for (const ControlLease::Result& result : lease.take_results()) {
      text += (text.empty() ? "" : "; ") + std::to_string(result.client) + ":" + std::to_string(result.operation) +
              " " + (result.error.empty() ? "ok" : result.error);
    }
    return text;
  }
  json holder() const { return lease.document(now)["holder"]; }

  ControlLease lease;
  ServerTime now = 1h;
};

TEST_F(Lease, AtFirstNobodyHasControl) {
  EXPECT_EQ(lease.document(now), json::parse(R"({"epoch": 0, "holder": null, "away": false, "request": null})"));
  EXPECT_EQ(lease.refusal(anna, 0), "nobody has control: take it first");
  EXPECT_EQ(lease.deadline(), no_deadline);
}

TEST_F(Lease, TheFirstWhoTakesItGetsIt) {
  anna_takes();
  EXPECT_EQ(lease.document(now),
            json::parse(R"({"epoch": 1, "holder": {"client": 1, "name": "Anna"}, "away": false, "request": null})"));
  EXPECT_EQ(lease.refusal(anna, 1), "");
  EXPECT_EQ(lease.refusal(ben, 1), "control is with Anna");
  EXPECT_EQ(lease.refusal(anna, 0), "found epoch 0 of control, expected 1");
}

TEST_F(Lease, IsGivenToAViewerThatHasRequestedNothingIfNobodyHasItOrTheHolderIsAway) {
  lease.give(now, anna, "Anna");
  EXPECT_EQ(results(), "") << "there is no operation to answer";
  EXPECT_EQ(lease.refusal(anna, 1), "");
  const std::uint64_t revision = lease.revision();
  lease.give(now, ben, "Ben");
  EXPECT_EQ(holder()["client"], anna);
  EXPECT_EQ(lease.revision(), revision);
  now += 400ms;
  lease.give(now, ben, "Ben");
  EXPECT_EQ(holder()["client"], ben);
}

TEST_F(Lease, TakingItTwiceChangesNothing) {
  anna_takes();
  const std::uint64_t revision = lease.revision();
  lease.take(now, anna, "Anna", 2);
  EXPECT_EQ(results(), "1:2 ok");
  EXPECT_EQ(lease.epoch(), 1U);
  EXPECT_EQ(lease.revision(), revision);
}

TEST_F(Lease, AHolderThatDoesNotAnswerLosesItAfterTenSeconds) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  const ServerTime asked = now;
  EXPECT_EQ(lease.document(now)["request"], json::parse(R"({"client": 2, "name": "Ben", "ms": 10000})"));
  pass(9'999ms, anna);
  EXPECT_EQ(results(), "");
  EXPECT_EQ(lease.document(now)["request"]["ms"], 1);
  EXPECT_EQ(lease.deadline(), asked + 10s);
  now = asked + 10s;
  lease.advance(now);
  EXPECT_EQ(results(), "2:5 ok");
  EXPECT_EQ(lease.epoch(), 2U);
  EXPECT_EQ(lease.refusal(anna, 1), "control is with Ben");
  EXPECT_EQ(lease.refusal(ben, 2), "");
  EXPECT_EQ(lease.document(now)["request"], nullptr);
}

TEST_F(Lease, AHolderMayRefuse) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  lease.answer(now, anna, 1, 2, false);
  EXPECT_EQ(results(), "1:2 ok; 2:5 Anna keeps control");
  pass(20s, anna);
  EXPECT_EQ(lease.refusal(anna, 1), "") << "the old request has no effect later";
}

TEST_F(Lease, AHolderMayGrant) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  lease.answer(now, anna, 1, 2, true);
  EXPECT_EQ(results(), "1:2 ok; 2:5 ok");
  EXPECT_EQ(holder(), json::parse(R"({"client": 2, "name": "Ben"})"));
}

TEST_F(Lease, OnlyTheHolderAnswersAndOnlyARequest) {
  anna_takes();
  lease.answer(now, anna, 1, 2, true);
  EXPECT_EQ(results(), "1:2 nobody asks for control");
  lease.take(now, ben, "Ben", 5);
  lease.answer(now, ben, 1, 6, true);
  EXPECT_EQ(results(), "2:6 control is with Anna");
  lease.answer(now, anna, 0, 3, true);
  EXPECT_EQ(results(), "1:3 found epoch 0 of control, expected 1");
  EXPECT_EQ(holder()["name"], "Anna");
}

TEST_F(Lease, WhileOneAsksOthersAreRefused) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  pass(4s, anna);
  lease.take(now, carl, "Carl", 6);
  EXPECT_EQ(results(), "3:6 Ben has already asked Anna for control");
  lease.take(now, ben, "Ben", 7);
  EXPECT_EQ(results(), "2:7 Ben has already asked Anna for control");
  EXPECT_EQ(lease.document(now)["request"]["ms"], 6000) << "and the time goes on";
}

TEST_F(Lease, AReleasedLeaseIsFree) {
  anna_takes();
  lease.release(now, ben, 1, 9);
  EXPECT_EQ(results(), "2:9 control is with Anna");
  lease.release(now, anna, 1, 2);
  EXPECT_EQ(results(), "1:2 ok");
  EXPECT_EQ(holder(), nullptr);
  EXPECT_EQ(lease.refusal(anna, 1), "nobody has control: take it first");
  lease.take(now, anna, "Anna", 3);
  EXPECT_EQ(lease.refusal(anna, 1), "found epoch 1 of control, expected 2") << "operations under way have no effect";
}

TEST_F(Lease, AReleasedOrAbandonedLeasePassesToWhoAsks) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  lease.release(now, anna, 1, 2);
  EXPECT_EQ(results(), "1:2 ok; 2:5 ok");
  lease.take(now, carl, "Carl", 6);
  lease.leave(now, ben);
  EXPECT_EQ(results(), "3:6 ok");
  EXPECT_EQ(lease.epoch(), 3U);
}

TEST_F(Lease, WhoAskedAndWentGetsNothing) {
  anna_takes();
  lease.take(now, ben, "Ben", 5);
  lease.leave(now, ben);
  EXPECT_EQ(lease.document(now)["request"], nullptr);
  pass(20s, anna);
  EXPECT_EQ(results(), "");
  EXPECT_EQ(holder()["name"], "Anna");
}

TEST_F(Lease, AHolderWithoutASignOfLifeFor400MillisecondsIsAway) {
  anna_takes();
  EXPECT_EQ(lease.deadline(), now + 400ms);
  lease.advance(now + 399ms);
  EXPECT_FALSE(lease.is_away());
  lease.advance(now + 400ms);
  EXPECT_TRUE(lease.is_away());
  EXPECT_EQ(lease.deadline(), no_deadline);
  EXPECT_EQ(lease.refusal(anna, 1), "") << "it may still drive";
  lease.beat(now + 5s, anna, 10);
  EXPECT_FALSE(lease.is_away());
}

TEST_F(Lease, ASignOfLifeOfADeadMainThreadDoesNotCount) {
  anna_takes();
  lease.beat(now + 250ms, anna, 500);
  lease.beat(now + 300ms, ben, 0);
  lease.advance(now + 400ms);
  EXPECT_TRUE(lease.is_away());
  lease.beat(now + 2s, anna, 1e300);
  EXPECT_TRUE(lease.is_away());
  lease.beat(now + 2s, anna, 499.9);
  EXPECT_FALSE(lease.is_away());
}

TEST_F(Lease, OfAHolderThatIsAwayAnybodyTakesItAtOnce) {
  anna_takes();
  lease.take(now + 400ms, ben, "Ben", 5);
  EXPECT_EQ(results(), "2:5 ok");
  EXPECT_FALSE(lease.is_away());
}

TEST_F(Lease, ARequestPassesWhenTheHolderGoesAway) {
  anna_takes();
  lease.take(now + 250ms, ben, "Ben", 5);
  lease.advance(now + 399ms);
  EXPECT_EQ(results(), "");
  lease.advance(now + 400ms);
  EXPECT_EQ(results(), "2:5 ok");
}

TEST_F(Lease, ItsRevisionChangesWithItsDocument) {
  std::uint64_t revision = lease.revision();
  const auto changed = [&] { return lease.revision() != std::exchange(revision, lease.revision()); };
  anna_takes();
  EXPECT_TRUE(changed());
  lease.beat(now, anna, 1);
  EXPECT_FALSE(changed());
  lease.take(now, ben, "Ben", 1);
  EXPECT_TRUE(changed());
  lease.answer(now, anna, 1, 2, false);
  EXPECT_TRUE(changed());
  lease.advance(now + 1s);
  EXPECT_TRUE(changed());
  lease.advance(now + 2s);
  EXPECT_FALSE(changed());
  lease.leave(now + 2s, carl);
  EXPECT_FALSE(changed());
  lease.leave(now + 2s, anna);
  EXPECT_TRUE(changed());
}

}  // namespace
}  // namespace proleg::host
