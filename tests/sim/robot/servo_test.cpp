#include "sim/robot/servo.hpp"

#include <gtest/gtest.h>

#include <random>

namespace proleg::sim {
namespace {

constexpr ServoCurrent servo;
constexpr double max_speed = 5.2;  // rad/s: 60 degrees in 0.2 s

double current(double commanded, double actual) { return servo_current_ma(servo, commanded, actual, max_speed); }

TEST(ServoCurrents, AreThoseOfDataSheetsOfStandardRcServos) {
  EXPECT_GE(servo.idle_ma, 5.0);
  EXPECT_LE(servo.idle_ma, 10.0);
  EXPECT_GE(servo.no_load_ma, 150.0);
  EXPECT_LE(servo.no_load_ma, 250.0);
  EXPECT_GE(servo.stall_ma, 700.0);
  EXPECT_LT(servo.stall_ma, 2'000.0) << "the default limit of a module, 0x200A:1";
}

TEST(ServoCurrents, AtRestAtFullSpeedAndHeld) {
  EXPECT_EQ(current(0, 0), servo.idle_ma);
  for (const double direction : {1.0, -1.0}) {
    EXPECT_DOUBLE_EQ(current(direction * max_speed, direction * max_speed), servo.no_load_ma);
    EXPECT_DOUBLE_EQ(current(direction * max_speed, 0), servo.stall_ma);
    EXPECT_DOUBLE_EQ(current(direction * max_speed / 2, 0), (servo.stall_ma + servo.idle_ma) / 2);
  }
}

TEST(ServoCurrents, RiseWithTheLoadAndRemainInTheirRange) {
  constexpr std::uint32_t seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> speed(-2 * max_speed, 2 * max_speed);
  for (int run = 0; run < 10'000; ++run) {
    const double commanded = speed(random);
    const double actual = speed(random);
    const double now = current(commanded, actual);
    EXPECT_GE(now, servo.idle_ma);
    EXPECT_LE(now, servo.stall_ma);
    EXPECT_EQ(current(-commanded, -actual), now);
    EXPECT_GE(current(actual + 1.5 * (commanded - actual), actual), now);
  }
}

}  // namespace
}  // namespace proleg::sim
