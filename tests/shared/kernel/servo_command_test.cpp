#include "shared/kernel/servo_pulses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "robot.hpp"

namespace proleg {
namespace {

constexpr std::int32_t right_angle = 1 << 30;

// Pulse width in twelfths of a microsecond: 0.5, 1.5 and 2.5 ms.
TEST(ServoCommand, IsExactAtTheEndsAndInTheMiddle) {
  EXPECT_EQ(servo_command(-right_angle), 500 * 12);
  EXPECT_EQ(servo_command(0), 1500 * 12);
  EXPECT_EQ(servo_command(right_angle), 2500 * 12);
  EXPECT_EQ(servo_command(right_angle / 2), 2000 * 12);
}

TEST(ServoCommand, ClampsAnglesBeyondNinetyDegrees) {
  EXPECT_EQ(servo_command(right_angle + 1), servo_command(right_angle));
  EXPECT_EQ(servo_command(std::numeric_limits<std::int32_t>::max()), servo_command(right_angle));
  EXPECT_EQ(servo_command(-right_angle - 1), servo_command(-right_angle));
  EXPECT_EQ(servo_command(std::numeric_limits<std::int32_t>::min()), servo_command(-right_angle));
}

TEST(ServoCommand, NeverFallsWhenTheAngleRisesAndIsTheNearestCount) {
  std::int32_t before = servo_command(-right_angle);
  for (std::int64_t angle = -right_angle; angle <= right_angle; angle += 97) {
    const std::int32_t command = servo_command(static_cast<std::int32_t>(angle));
    ASSERT_GE(command, before);
    ASSERT_LE(std::abs(command - (18000 + 12000.0 * static_cast<double>(angle) / right_angle)), 0.5);
    before = command;
  }
}

// protocol.md: at least 0.01 degree fine. The first angle with another command is not further away than that.
TEST(ServoCommand, DistinguishesAnglesAHundredthOfADegreeApart) {
  const std::int32_t hundredth = test::degrees(0.01);
  for (std::int64_t angle = -right_angle; angle + hundredth <= right_angle; angle += 10'007) {
    ASSERT_NE(servo_command(static_cast<std::int32_t>(angle)),
              servo_command(static_cast<std::int32_t>(angle + hundredth)))
        << test::in_degrees(static_cast<std::int32_t>(angle));
  }
}

TEST(Interpolate, IsExactAtBothEnds) {
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t from : {lowest, -1, 0, 1, 12345, highest}) {
    for (const std::int32_t to : {lowest, -1, 0, 1, 54321, highest}) {
      EXPECT_EQ(interpolate(from, to, 0), from);
      EXPECT_EQ(interpolate(from, to, 1 << 16), to);
    }
  }
}

TEST(Interpolate, IsLinearWithinAStep) {
  std::mt19937 random(16);
  for (int i = 0; i < 100'000; ++i) {
    const auto from = static_cast<std::int32_t>(random());
    const auto to = static_cast<std::int32_t>(random());
    const auto fraction = static_cast<std::int32_t>(random() % 65537);
    const double exact = from + (static_cast<double>(to) - from) * fraction / 65536.0;
    ASSERT_LE(std::abs(interpolate(from, to, fraction) - exact), 1.0) << from << " " << to << " " << fraction;
  }
}

TEST(SampleFraction, IsTheMiddleOfTheServosIntervalWithinTheTick) {
  // Interval starts and servo periods within a tick of 10 ms, in microseconds.
  EXPECT_EQ(sample_fraction(0, 1'000, 10'000), 2 * (32768 * 500 / 10'000));
  EXPECT_EQ(sample_fraction(9'000, 1'000, 10'000), 2 * (32768 * 9'500 / 10'000));
  for (std::uint32_t elapsed = 0; elapsed < 10'000; elapsed += 1'000) {
    EXPECT_NEAR(sample_fraction(elapsed, 1'000, 10'000) / 65536.0, (elapsed + 500) / 10'000.0, 2.0 / 65536);
  }
  for (const std::uint32_t elapsed : {0U, 3'000U, 6'000U}) {
    EXPECT_NEAR(sample_fraction(elapsed, 3'000, 10'000) / 65536.0, (elapsed + 1'500) / 10'000.0, 2.0 / 65536);
  }
}

// The line to the tick after the coming one is not known yet.
TEST(SampleFraction, EndsAtTheComingTickWhenTheMiddleLiesBeyondIt) {
  EXPECT_EQ(sample_fraction(9'000, 3'000, 10'000), 1 << 16);
  EXPECT_EQ(sample_fraction(0, 20'000, 10'000), 1 << 16);
  EXPECT_EQ(sample_fraction(5'000, 20'000, 10'000), 1 << 16);
}

TEST(SampleFraction, StaysWithinTheLineForEveryTickAndPeriod) {
  std::mt19937 random(17);
  for (int i = 0; i < 100'000; ++i) {
    const auto tick = static_cast<std::uint32_t>(1'000 + random() % 99'001);
    const auto elapsed = static_cast<std::uint32_t>(random() % tick);
    const auto period = static_cast<std::uint32_t>(100 + random() % 20'000);
    const double exact = std::min(1.0, (elapsed + period / 2) / static_cast<double>(tick));
    ASSERT_LE(std::abs(sample_fraction(elapsed, period, tick) / 65536.0 - exact), 2.0 / 65536);
  }
}

}  // namespace
}  // namespace proleg
