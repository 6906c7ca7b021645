#include "sim/hardware_loop/crystal.hpp"

#include <gtest/gtest.h>

#include <random>

namespace proleg::sim {
namespace {

TEST(Crystal, AnExactOneShowsWholeMicrosecondsOfTrueTime) {
  const Crystal crystal(0);
  EXPECT_EQ(crystal.at(0), 0U);
  EXPECT_EQ(crystal.at(999), 0U);
  EXPECT_EQ(crystal.at(1'000), 1U);
  EXPECT_EQ(crystal.when(7), 7'000U);
}

TEST(Crystal, AFastOneIsAheadByItsError) {
  const BusTime hour = 3'600'000'000'000;
  EXPECT_EQ(Crystal(100'000).at(hour), 3'600'360'000U) << "100 ppm of an hour are 0.36 s";
  EXPECT_EQ(Crystal(-100'000).at(hour), 3'599'640'000U);
}

TEST(Crystal, WhenIsTheFirstTimeAtWhichItShowsThatMuch) {
  constexpr std::uint32_t seed = 20261120;
  std::mt19937_64 random(seed);
  RecordProperty("seed", seed);
  for (int i = 0; i < 20'000; ++i) {
    const Crystal crystal(static_cast<std::int32_t>(random() % 1'000'001) - 500'000);
    const Microseconds shown = random() % 86'400'000'000;  // a day
    const BusTime time = crystal.when(shown);
    ASSERT_GE(crystal.at(time), shown) << crystal.parts_per_billion();
    if (time > 0) {
      ASSERT_LT(crystal.at(time - 1), shown) << crystal.parts_per_billion();
    }
  }
  EXPECT_EQ(Crystal(5).when(never), never_on_bus);
}

}  // namespace
}  // namespace proleg::sim
