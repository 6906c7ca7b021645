#include "shared/fixed/sine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>

namespace proleg {
namespace {

constexpr std::int32_t one = 1 << 30;
constexpr std::uint32_t quarter = 0x40000000U;
// Step of the sweep. It is a prime, so that the sweep meets every residue of the smaller powers of two.
constexpr std::uint32_t stride = 421;

long double true_sine(std::uint32_t phase) {
  return std::sin(2 * std::numbers::pi_v<long double> * static_cast<long double>(phase) / 4294967296.0L);
}

template <typename Visit>
void sweep_the_turn(Visit visit) {
  for (std::uint64_t phase = 0; phase < (std::uint64_t{1} << 32U); phase += stride) {
    visit(static_cast<std::uint32_t>(phase));
  }
}

TEST(Sine, ErrsByNoMoreThanRequiredAndNoMoreThanDeclared) {
  long double largest = 0;
  long double sum = 0;
  std::uint64_t count = 0;
  sweep_the_turn([&](std::uint32_t phase) {
    const long double error = static_cast<long double>(sine(phase)) / one - true_sine(phase);
    largest = std::max(largest, std::abs(error));
    sum += error;
    ++count;
  });
  std::cout << "largest error " << largest << ", mean error " << sum / static_cast<long double>(count) << '\n';
  EXPECT_LE(largest, 7e-7L);
  EXPECT_LE(largest, 7.3e-9L);
}

TEST(Sine, IsOddToTheLastBit) {
  std::uint64_t violations = 0;
  sweep_the_turn([&](std::uint32_t phase) { violations += sine(0U - phase) != -sine(phase) ? 1U : 0U; });
  EXPECT_EQ(violations, 0U);
}

TEST(Sine, NeverGoesBeyondTheCrest) {
  std::uint64_t violations = 0;
  sweep_the_turn([&](std::uint32_t phase) {
    const std::int32_t value = sine(phase);
    violations += value > one || value < -one ? 1U : 0U;
  });
  EXPECT_EQ(violations, 0U);
}

TEST(Sine, IsZeroAtZeroAndAtHalfATurn) {
  EXPECT_EQ(sine(0), 0);
  EXPECT_EQ(sine(0x80000000U), 0);
}

TEST(Sine, IsOneAtTheCrests) {
  EXPECT_EQ(sine(quarter), one);
  EXPECT_EQ(sine(3 * quarter), -one);
}

// The steps between adjacent inputs are what counts, so windows of adjacent inputs are taken, the crest included.
TEST(Sine, RisingQuarterStepsBackByAtMostFourStepsAsRequiredAndOneAsDeclared) {
  std::int32_t largest_step_back = 0;
  constexpr std::uint32_t window = 4096;
  const auto look_at = [&](std::uint32_t first) {
    std::int32_t highest = sine(first);
    for (std::uint32_t phase = first; phase < first + window; ++phase) {
      const std::int32_t value = sine(phase);
      largest_step_back = std::max(largest_step_back, highest - value);
      highest = std::max(highest, value);
    }
  };
  for (std::uint32_t first = 0; first + window <= quarter; first += 131 * window) {
    look_at(first);
  }
  look_at(quarter - window + 1);
  std::cout << "largest step back " << largest_step_back << " lsb\n";
  EXPECT_LE(largest_step_back, 4);
  EXPECT_LE(largest_step_back, 1);
}

TEST(Cosine, IsTheSineAQuarterTurnAhead) {
  EXPECT_EQ(cosine(0), one);
  EXPECT_EQ(cosine(quarter), 0);
  EXPECT_EQ(cosine(2 * quarter), -one);
  // cos 60 degrees = 1/2
  EXPECT_NEAR(static_cast<double>(cosine(0x2AAAAAABU)) / one, 0.5, 8e-9);
}

}  // namespace
}  // namespace proleg
