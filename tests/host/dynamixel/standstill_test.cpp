#include "host/dynamixel/standstill.hpp"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <functional>
#include <vector>

namespace proleg::host {
namespace {

constexpr std::uint64_t tick_us = 10'000;

/// The times in ms at which a servo is reported whose position and goal are functions of the time in seconds.
std::vector<std::uint64_t> reports(const std::function<double(double)>& position,
                                   const std::function<double(double)>& goal, double end_s = 5.0) {
  Standstill standstill;
  std::vector<std::uint64_t> times;
  for (std::uint64_t time_us = 0; static_cast<double>(time_us) < end_s * 1e6; time_us += tick_us) {
    const double time_s = static_cast<double>(time_us) / 1e6;
    if (standstill.add(static_cast<std::int32_t>(position(time_s)), static_cast<std::int32_t>(goal(time_s)), time_us)) {
      times.push_back(time_us / 1000);
    }
  }
  return times;
}

double fixed(double /*time_s*/) { return 2048; }
/// 40 degrees at 1 Hz.
double wave(double time_s) { return 2048 + 455 * std::sin(6.283 * time_s); }

TEST(Standstill, IsReportedAfterOneSecondTwoAndFour) {
  EXPECT_EQ(reports(fixed, [](double) { return 2148.0; }), (std::vector<std::uint64_t>{1000, 2000, 4000}));
}

TEST(Standstill, AGoalThatPassesTheServoDoesNotEndIt) {
  // An angle of 5 degrees is exceeded in 92 % of the time.
  const std::vector<std::uint64_t> times = reports(fixed, wave);
  ASSERT_FALSE(times.empty());
  EXPECT_NEAR(static_cast<double>(times[0]), 1000 / 0.92, 50);
}

TEST(Standstill, HasTheGreatestDifferenceInSteps) {
  Standstill standstill;
  static_cast<void>(standstill.add(2048, 2048, 0));
  static_cast<void>(standstill.add(2048, 2648, 500'000));
  const auto report = standstill.add(2050, 2150, 1'000'000);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->max_difference, 600);
  EXPECT_EQ(report->time_us, 1'000'000U);
}

TEST(Standstill, IsNotThatOfAServoThatIsSlowOrWaitsAtItsGoal) {
  EXPECT_TRUE(reports([](double time_s) { return 2048 + 60 * time_s; }, [](double) { return 3000.0; }).empty());
  EXPECT_TRUE(reports(fixed, fixed).empty());
  EXPECT_TRUE(reports(fixed, [](double) { return 2090.0; }).empty());  // a load turns it by less than 4 degrees
  // It waits for three seconds, and follows with a delay of half a second.
  const auto after = [](double start_s) { return [=](double time_s) { return time_s < start_s ? 2048 : 2448; }; };
  EXPECT_TRUE(reports(after(3.5), after(3.0)).empty());
}

TEST(Standstill, AnyNumbersAreAllowed) {
  Standstill standstill;
  static_cast<void>(standstill.add(INT_MIN, INT_MAX, 0));
  static_cast<void>(standstill.add(INT_MAX, INT_MIN, 1'000'000));
  EXPECT_FALSE(standstill.add(INT_MIN, INT_MAX, 2'000'000));
}

}  // namespace
}  // namespace proleg::host
