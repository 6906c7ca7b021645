#include "shared/fixed/polar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>

namespace proleg {
namespace {

struct Errors {
  double angle = 0;   ///< turns
  double length = 0;  ///< steps
};

Errors errors_of(std::int32_t x, std::int32_t y) {
  const Polar found = polar(x, y);
  const double turns = std::atan2(y, x) / (2 * std::numbers::pi) - found.angle / 4294967296.0;
  return {std::abs(std::remainder(turns, 1.0)), std::abs(found.length - std::hypot(x, y))};
}

TEST(Polar, ErrsByLessThanItsHeaderSaysInAllDirectionsAndLengths) {
  double largest_turns = 0;
  for (const double length : {536870000.0, 268435456.0, 16777216.0, 65536.0, 1000.0}) {
    for (int i = 0; i < 20'000; ++i) {
      const double angle = 2 * std::numbers::pi * i / 20'000;
      const auto x = static_cast<std::int32_t>(std::lround(length * std::cos(angle)));
      const auto y = static_cast<std::int32_t>(std::lround(length * std::sin(angle)));
      const Errors errors = errors_of(x, y);
      ASSERT_LE(errors.angle, 2e-6 + 0.4 * 20 / length) << x << ", " << y;
      ASSERT_LE(errors.length, 2e-6 * length + 15) << x << ", " << y;
      largest_turns = length > 1e8 ? std::max(largest_turns, errors.angle) : largest_turns;
    }
  }
  std::cout << "largest error of long vectors: " << largest_turns << " turns\n";
}

TEST(Polar, GivesTheZeroVectorNoLength) { EXPECT_EQ(polar(0, 0).length, 0); }

TEST(Polar, TakesLongerVectorsAsTheNearestOfItsRange) {
  const std::int32_t most = std::numeric_limits<std::int32_t>::max();
  const std::int32_t least = std::numeric_limits<std::int32_t>::min();
  EXPECT_EQ(polar(most, most).angle, polar(1 << 29, 1 << 29).angle);
  EXPECT_EQ(polar(least, most).length, polar(-(1 << 29), 1 << 29).length);
  EXPECT_NEAR(polar(least, least).angle / 4294967296.0, -0.375, 2e-6);
}

}  // namespace
}  // namespace proleg
