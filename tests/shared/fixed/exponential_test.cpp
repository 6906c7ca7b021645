#include "shared/fixed/exponential.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>

namespace proleg {
namespace {

constexpr double one = 1 << 30;

double error_in_steps(std::int32_t x) {
  return std::abs(exponential_decay(x) - std::exp(-static_cast<double>(x) / (1 << 24)) * one);
}

TEST(ExponentialDecay, ErrsByAtMostTwoStepsOfQ30) {
  double largest = 0;
  // Values up to 2, where filters work, are dense; then they go to 128.
  for (std::int32_t x = 0; x < 2 << 24; x += 7) {
    largest = std::max(largest, error_in_steps(x));
  }
  for (std::int64_t x = 0; x <= std::numeric_limits<std::int32_t>::max(); x += 1009) {
    largest = std::max(largest, error_in_steps(static_cast<std::int32_t>(x)));
  }
  std::cout << "largest error " << largest << " lsb of Q30\n";
  EXPECT_LE(largest, 2.0);
}

TEST(ExponentialDecay, IsOneAtZeroAndBelow) {
  EXPECT_EQ(exponential_decay(0), 1 << 30);
  EXPECT_EQ(exponential_decay(-1), 1 << 30);
  EXPECT_EQ(exponential_decay(std::numeric_limits<std::int32_t>::min()), 1 << 30);
}

TEST(ExponentialDecay, VanishesAtTheEndOfItsRange) {
  EXPECT_EQ(exponential_decay(std::numeric_limits<std::int32_t>::max()), 0);
}

// algorithms: a filter of rate 20 1/s loses exp(-0.1) in 10 ms.
TEST(ExponentialDecay, GivesThePublishedConstantOfAFilterOfRate20) {
  const std::int32_t tenth = (1 << 24) / 10;
  EXPECT_NEAR(exponential_decay(tenth) / one, 0.904837418, 1e-7);
}

}  // namespace
}  // namespace proleg
