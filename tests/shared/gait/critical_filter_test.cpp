#include "shared/gait/critical_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>

#include "robot.hpp"

namespace proleg {
namespace {

constexpr std::int32_t forty_degrees = 477218588;

/// Step response of r'' = a (a/4 (R - r) - r') from rest at 0, as a share of R.
double step_response(double rate, double t) { return 1 - (1 + rate / 2 * t) * std::exp(-rate / 2 * t); }

struct Step {
  double rate;
  std::uint32_t tick_us;
};

class CriticalFilterOfEveryRate : public testing::TestWithParam<Step> {};

TEST_P(CriticalFilterOfEveryRate, FollowsTheAnalyticStepResponse) {
  const auto [rate, tick_us] = GetParam();
  const CriticalFilter filter = make_critical_filter(test::per_second(rate), tick_us);
  std::int32_t value = 0;
  std::int32_t speed = 0;
  double largest = 0;
  const auto ticks = static_cast<int>(40 / rate / (tick_us * 1e-6));
  for (int tick = 1; tick <= ticks; ++tick) {
    value = approach(filter, forty_degrees, value, speed);
    const double expected = 40 * step_response(rate, tick * (tick_us * 1e-6));
    largest = std::max(largest, std::abs(test::in_degrees(value) - expected));
  }
  std::cout << "largest error " << largest << " degrees\n";
  // The slowest filter jumps its last 64 + 4 / (h dt) = 80064 steps; the others stay far below.
  EXPECT_LE(largest, rate * tick_us < 1'000 ? 0.0068 : 0.001);
}

TEST_P(CriticalFilterOfEveryRate, NeverOvershootsFromRest) {
  const auto [rate, tick_us] = GetParam();
  const CriticalFilter filter = make_critical_filter(test::per_second(rate), tick_us);
  for (const std::int32_t target : {forty_degrees, -forty_degrees, 1 << 30, -(1 << 30), 100, 1}) {
    std::int32_t value = 0;
    std::int32_t speed = 0;
    for (int tick = 0; tick < static_cast<int>(60 / rate / (tick_us * 1e-6)); ++tick) {
      value = approach(filter, target, value, speed);
      ASSERT_LE(std::abs(std::int64_t{value}), std::abs(std::int64_t{target})) << "tick " << tick;
    }
  }
}

TEST_P(CriticalFilterOfEveryRate, EndsExactlyOnTheTarget) {
  const auto [rate, tick_us] = GetParam();
  const CriticalFilter filter = make_critical_filter(test::per_second(rate), tick_us);
  for (const std::int32_t target : {forty_degrees, -forty_degrees}) {
    std::int32_t value = 0;
    std::int32_t speed = 0;
    const auto ticks = static_cast<int>(60 / rate / (tick_us * 1e-6));
    for (int tick = 0; tick < ticks; ++tick) {
      value = approach(filter, target, value, speed);
    }
    EXPECT_EQ(value, target) << "off by " << value - target;
    EXPECT_EQ(speed, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, CriticalFilterOfEveryRate,
                         testing::Values(Step{20, 10'000}, Step{5, 10'000}, Step{100, 10'000}, Step{1, 10'000},
                                         Step{0.1, 10'000}, Step{20, 1'000}, Step{0.1, 1'000}, Step{20, 100'000}),
                         [](const testing::TestParamInfo<Step>& step) {
                           return "A" + std::to_string(static_cast<int>(std::lround(step.param.rate * 10))) +
                                  "PerTenSecondsAndTick" + std::to_string(step.param.tick_us) + "us";
                         });

// 95 % of a change takes 9.49 / a (generator_parameters.hpp); with a = 20, 0.4745 s.
TEST(CriticalFilter, Covers95PercentOfAStepIn949OverA) {
  const CriticalFilter filter = make_critical_filter(test::per_second(20), 1'000);
  std::int32_t value = 0;
  std::int32_t speed = 0;
  int ticks = 0;
  while (value < forty_degrees / 20 * 19) {
    value = approach(filter, forty_degrees, value, speed);
    ++ticks;
  }
  EXPECT_NEAR(ticks * 0.001, 9.49 / 20, 0.002);
}

TEST(CriticalFilter, HasTheDocumentedConstants) {
  const CriticalFilter filter = make_critical_filter(test::per_second(20), 10'000);
  EXPECT_NEAR(filter.half_rate / 1073741824.0, 0.1, 1e-8);
  EXPECT_NEAR(filter.decay / 1073741824.0, 0.904837418, 4e-8);
}

TEST(CriticalFilter, TreatsRatesAboveTwoPerTickAsTwoPerTick) {
  const CriticalFilter fastest = make_critical_filter(test::per_second(20), 100'000);
  const CriticalFilter faster = make_critical_filter(test::per_second(100), 100'000);
  EXPECT_EQ(faster.half_rate, fastest.half_rate);
  EXPECT_EQ(faster.decay, fastest.decay);
  EXPECT_EQ(fastest.half_rate, 1 << 30);
}

// Values that a distortion can set. The filter saturates on its way and still arrives.
TEST(CriticalFilter, RecoversFromTheMostExtremeValues) {
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();
  const CriticalFilter filter = make_critical_filter(test::per_second(20), 10'000);
  for (const std::int32_t start : {lowest, highest}) {
    for (const std::int32_t start_speed : {lowest, 0, highest}) {
      for (const std::int32_t target : {-(1 << 30), 1 << 30}) {
        std::int32_t value = start;
        std::int32_t speed = start_speed;
        for (int tick = 0; tick < 1000; ++tick) {
          value = approach(filter, target, value, speed);
        }
        EXPECT_EQ(value, target);
        EXPECT_EQ(speed, 0);
      }
    }
  }
}

}  // namespace
}  // namespace proleg
