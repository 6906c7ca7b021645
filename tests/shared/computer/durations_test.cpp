#include "shared/computer/durations/durations.hpp"

#include <gtest/gtest.h>

namespace proleg {
namespace {

TEST(Durations, HaveNoPercentileWithoutAny) {
  EXPECT_EQ(Durations().count(), 0U);
  EXPECT_FALSE(Durations().median());
}

TEST(Durations, ThePercentileIsThatOfTheNearestRank) {
  Durations durations;
  for (unsigned duration = 200; duration > 0; --duration) {
    durations.add(duration);
  }
  EXPECT_EQ(durations.count(), 200U);
  EXPECT_EQ(durations.percentile(1), 2U);
  EXPECT_EQ(durations.median(), 100U);
  EXPECT_EQ(durations.percentile(99), 198U);
  EXPECT_EQ(durations.percentile(100), 200U);
}

TEST(Durations, OneSlowInAHundredIsNotTheNinetyNinthPercentile) {
  Durations durations;
  for (unsigned i = 0; i < 99; ++i) {
    durations.add(300);
  }
  durations.add(150'000);
  EXPECT_EQ(durations.percentile(99), 300U);
  durations.add(150'000);
  EXPECT_EQ(durations.percentile(99), 150'000U);
}

TEST(Durations, KeepThreeDigits) {
  const auto kept = [](std::uint64_t duration) {
    Durations durations;
    durations.add(duration);
    return durations.median();
  };
  EXPECT_EQ(kept(0), 0U);
  EXPECT_EQ(kept(999), 999U);
  EXPECT_EQ(kept(1'004), 1'000U);
  EXPECT_EQ(kept(1'005), 1'010U);
  EXPECT_EQ(kept(123'456'789), 123'000'000U);
  EXPECT_EQ(kept(999'999), 1'000'000U);
}

}  // namespace
}  // namespace proleg
