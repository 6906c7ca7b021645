// The tick of a SYNC. The oracle knows the absolute tick of every SYNC.

#include "firmware/module/sync.hpp"

#include <gtest/gtest.h>

namespace proleg::firmware {
namespace {

using Action = SyncMeaning::Action;

std::uint8_t counter(std::uint32_t tick) { return static_cast<std::uint8_t>(tick % 128 + 1); }

/// A keeper that computes, so that `coming` is the coming tick.
TickKeeper computing(std::uint32_t coming) {
  TickKeeper keeper;
  EXPECT_TRUE(keeper.announce(coming - 2, 0));
  EXPECT_EQ(keeper.sync(counter(coming - 2), 0).action, Action::join);
  EXPECT_EQ(keeper.sync(counter(coming - 1), coming - 1).action, Action::compute);
  EXPECT_TRUE(keeper.synchronised());
  return keeper;
}

TEST(TickKeeper, UnderstandsEverySyncByItsDistanceFromTheComingTick) {
  for (std::uint32_t coming = 200; coming < 200 + 128; ++coming) {
    for (int distance = -60; distance < 67; ++distance) {
      TickKeeper keeper = computing(coming);
      const SyncMeaning meaning = keeper.sync(counter(coming + static_cast<std::uint32_t>(distance)), coming);
      if (distance == -1) {  // a duplicate
        EXPECT_EQ(meaning.action, Action::none);
        EXPECT_FALSE(meaning.lost);
        EXPECT_TRUE(keeper.synchronised());
      } else if (distance >= 0 && distance <= 8) {
        EXPECT_EQ(meaning.action, Action::compute);
        EXPECT_EQ(meaning.missed, distance);
        EXPECT_FALSE(meaning.lost);
        EXPECT_TRUE(keeper.synchronised());
      } else {
        EXPECT_EQ(meaning.action, Action::none);
        EXPECT_TRUE(meaning.lost);
        EXPECT_FALSE(keeper.keeps_tick());
      }
    }
  }
}

TEST(TickKeeper, UnderstandsEveryTickByItsDistanceFromTheComingTick) {
  for (const std::uint32_t coming : {3U, 10U, 1'000U, 0x80000000U, 0xFFFFFFF0U}) {
    for (int distance = -50; distance <= 50; ++distance) {
      TickKeeper keeper = computing(coming);
      const auto tick = coming + static_cast<std::uint32_t>(distance);
      const bool fits = distance >= -8 && distance <= 8;
      EXPECT_EQ(keeper.announce(tick, coming), fits);
      EXPECT_EQ(keeper.synchronised(), fits);
      if (fits && distance < 0) {  // late: it says nothing of the coming SYNC
        EXPECT_EQ(keeper.sync(counter(coming), coming).action, Action::compute);
        continue;
      }
      // This is the SYNC that TICK has announced.
      const SyncMeaning meaning = keeper.sync(counter(tick), coming);
      if (fits) {
        EXPECT_EQ(meaning.action, Action::compute);
        EXPECT_EQ(meaning.missed, distance);
      } else {
        EXPECT_EQ(meaning.action, tick == 0 ? Action::compute : Action::join);
        EXPECT_EQ(meaning.tick, tick);
        EXPECT_FALSE(meaning.lost);
      }
    }
  }
}

TEST(TickKeeper, BelievesNeitherIfTickAndSyncDisagree) {
  TickKeeper keeper = computing(100);
  EXPECT_TRUE(keeper.announce(103, 100));
  const SyncMeaning meaning = keeper.sync(counter(100), 100);
  EXPECT_TRUE(meaning.lost);
  EXPECT_EQ(meaning.action, Action::none);
  EXPECT_FALSE(keeper.keeps_tick());
}

// The SYNC that was announced may be among those that were missed.
TEST(TickKeeper, MissesSyncsAfterTickAsAtAnyTime) {
  for (std::uint32_t missed = 0; missed <= 8; ++missed) {
    for (std::uint32_t announced = 100; announced <= 100 + missed; ++announced) {
      TickKeeper keeper = computing(100);
      ASSERT_TRUE(keeper.announce(announced, 100));
      const SyncMeaning meaning = keeper.sync(counter(100 + missed), 100);
      EXPECT_EQ(meaning.action, Action::compute) << announced << ' ' << missed;
      EXPECT_EQ(meaning.missed, missed);
      EXPECT_TRUE(keeper.synchronised());
    }
  }
}

TEST(TickKeeper, KnowsNoTickWithoutAnAnnouncement) {
  TickKeeper keeper;
  for (unsigned i = 1; i <= 128; ++i) {
    const SyncMeaning meaning = keeper.sync(static_cast<std::uint8_t>(i), 0);
    EXPECT_EQ(meaning.action, Action::none);
    EXPECT_FALSE(meaning.lost);
  }
  EXPECT_FALSE(keeper.keeps_tick());
}

TEST(TickKeeper, AnAnnouncementCountsForTheNextSyncOnly) {
  TickKeeper keeper;
  EXPECT_TRUE(keeper.announce(40, 0));
  EXPECT_EQ(keeper.sync(counter(39), 0).action, Action::none);
  EXPECT_EQ(keeper.sync(counter(40), 0).action, Action::none);
  EXPECT_TRUE(keeper.announce(50, 0));
  EXPECT_EQ(keeper.sync(counter(50), 0).action, Action::join);
}

TEST(TickKeeper, IsSynchronisedWhenItHasComputedATick) {
  TickKeeper keeper;
  EXPECT_TRUE(keeper.announce(40, 0));
  EXPECT_EQ(keeper.sync(counter(40), 0).action, Action::join);
  EXPECT_TRUE(keeper.keeps_tick());
  EXPECT_FALSE(keeper.synchronised());
  const SyncMeaning first = keeper.sync(counter(43), 41);
  EXPECT_TRUE(first.joined);
  EXPECT_EQ(first.missed, 2);
  EXPECT_TRUE(keeper.synchronised());
  EXPECT_FALSE(keeper.sync(counter(44), 44).joined);
}

}  // namespace
}  // namespace proleg::firmware
