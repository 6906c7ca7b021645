#include "host/server/viewer.hpp"

#include <gtest/gtest.h>

namespace proleg::host {
namespace {

using namespace std::chrono_literals;

/// The stride after two seconds of so many ticks a second.
std::uint32_t stride_at(std::uint64_t ticks_per_second, std::uint64_t unread_rows = 1) {
  TickRate rate;
  for (ServerTime now = 0ms; now <= 2s; now += 10ms) {
    rate.update(now, ticks_per_second * static_cast<std::uint64_t>(now.count()) / 1000);
  }
  return rate.stride(unread_rows);
}

TEST(TickRate, GivesEveryTickUpToAThousandASecond) {
  EXPECT_EQ(stride_at(0), 1U);
  EXPECT_EQ(stride_at(100), 1U);
  EXPECT_EQ(stride_at(1000), 1U);
}

TEST(TickRate, ThinsFasterTicksByPowersOfTwo) {
  EXPECT_EQ(stride_at(1100), 2U);
  EXPECT_EQ(stride_at(2000), 2U);
  EXPECT_EQ(stride_at(2200), 4U);
  EXPECT_EQ(stride_at(20'000), 32U);
  EXPECT_EQ(stride_at(1'000'000'000), 1U << 15U);
}

TEST(TickRate, GivesFewerTicksToAViewerThatIsFarBehind) {
  EXPECT_EQ(stride_at(100, 256), 1U);
  EXPECT_EQ(stride_at(100, 2000), 8U);
  EXPECT_EQ(stride_at(20'000, 2000), 32U);
}

TEST(TickRate, FollowsTheRobot) {
  TickRate rate;
  rate.update(0ms, 0);
  rate.update(300ms, 3000);
  EXPECT_EQ(rate.stride(1), 16U);
  rate.update(600ms, 3030);
  EXPECT_EQ(rate.stride(1), 1U);
}

}  // namespace
}  // namespace proleg::host
