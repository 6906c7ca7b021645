#include "sim/record/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace proleg::sim {
namespace {

TEST(Axis, MapsItsEndsToPixels) {
  const Axis axis{-2.0, 6.0, 300.0, 100.0};
  EXPECT_DOUBLE_EQ(axis.pixel(-2.0), 300.0);
  EXPECT_DOUBLE_EQ(axis.pixel(6.0), 100.0);
  EXPECT_DOUBLE_EQ(axis.pixel(2.0), 200.0);
}

TEST(NiceStep, IsTheNextOfOneTwoFive) {
  EXPECT_DOUBLE_EQ(nice_step(1.0), 1.0);
  EXPECT_DOUBLE_EQ(nice_step(1.1), 2.0);
  EXPECT_DOUBLE_EQ(nice_step(2.1), 5.0);
  EXPECT_DOUBLE_EQ(nice_step(7.0), 10.0);
  EXPECT_DOUBLE_EQ(nice_step(0.3 / 3.0), 0.1);
  EXPECT_DOUBLE_EQ(nice_step(0.00021), 0.0005);
  EXPECT_DOUBLE_EQ(nice_step(34'000.0), 50'000.0);
}

TEST(Multiples, IncludeTheEndsOfTheRange) {
  const std::vector<double> values = multiples(-0.3, 0.3, 0.1);
  ASSERT_EQ(values.size(), 7U);
  EXPECT_NEAR(values.front(), -0.3, 1e-12);
  EXPECT_EQ(values[3], 0.0);
  EXPECT_TRUE(multiples(0.11, 0.19, 0.1).empty());
}

TEST(Spread, DoesNotMoveWhatIsApart) {
  EXPECT_EQ(spread({50.0, 10.0, 90.0}, 15.0, 0.0, 100.0), (std::vector<double>{50.0, 10.0, 90.0}));
}

TEST(Spread, KeepsTheGapTheOrderAndTheRange) {
  const std::vector<double> crowded{99.0, 98.0, 50.0, 97.0, 50.0};
  const std::vector<double> places = spread(crowded, 15.0, 0.0, 100.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE(places[i], 0.0);
    EXPECT_LE(places[i], 100.0);
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (i != j) {
        EXPECT_GE(std::abs(places[i] - places[j]), 15.0);
      }
      if (crowded[i] < crowded[j]) {
        EXPECT_LT(places[i], places[j]);
      }
    }
  }
}

}  // namespace
}  // namespace proleg::sim
