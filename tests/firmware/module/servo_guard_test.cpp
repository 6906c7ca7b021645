// Rules for all pulses, whatever computes the angles and whenever a pulse is requested.

#include "firmware/module/servo_driver.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "servo_recorder.hpp"
#include "shared/fixed/random.hpp"

namespace proleg::firmware {
namespace {

class Guard : public testing::Test {
 protected:
  static constexpr std::int32_t quarter = 1 << 30;
  static constexpr std::uint32_t period_us = 3'000;

  Guard() { guard.set_period(period_us); }

  test::ServoRecorder servo;
  ServoGuard guard{servo};
};

TEST_F(Guard, AJumpBecomesARampOfTheDefaultSpeed) {
  guard.command(0, -quarter);
  EXPECT_EQ(servo.widths.back(), 6'000);
  for (Microseconds n = 1; n <= 83; ++n) {
    guard.command(n * period_us, quarter);
    // The speed is 720 degrees a second, and a step 7.5 thousandths of a degree.
    EXPECT_NEAR(*servo.widths.back(), 6'000 + static_cast<double>(n) * 720 * 0.003 / 0.0075, 1);
  }
  guard.command(84 * period_us, quarter);
  EXPECT_EQ(servo.widths.back(), 30'000) << "180 degrees in a quarter of a second";
}

TEST_F(Guard, TheSpeedIsThatOfTheObjectAlsoAfterAnotherPeriod) {
  guard.set_command_speed(90);
  guard.set_period(20'000);
  guard.command(0, 0);
  guard.command(20'000, quarter);
  EXPECT_NEAR(*servo.widths.back(), 18'000 + 90 * 0.02 / 0.0075, 1);
  guard.reset();
  EXPECT_EQ(guard.command_speed(), default_command_speed);
}

TEST_F(Guard, ThePulseOfAnEarlySyncMovesToo) {
  guard.command(0, 0);
  guard.command(period_us, quarter);
  const std::int32_t first = guard.angle();
  guard.command(2 * period_us - 5, quarter);
  guard.command(2 * period_us, quarter);  // the interval after it begins with the SYNC
  EXPECT_EQ(guard.angle(), 3 * first);
}

TEST_F(Guard, PulsesThatComeTooOftenDoNotMoveFaster) {
  for (const Microseconds spacing : {Microseconds{1}, Microseconds{100}, Microseconds{1'500}, Microseconds{2'900}}) {
    guard.reset();
    guard.command(0, -quarter);
    Microseconds now = 0;
    while (guard.angle() != quarter) {
      guard.command(now += spacing, quarter);
      ASSERT_LE(now, 1'000'000U);
    }
    // 180 degrees; the credit of two and a half periods, and 1/64 for a slow clock.
    EXPECT_GE(static_cast<double>(now), (250'000 - 2.5 * period_us) / (1 + 1.0 / 63)) << spacing << " us apart";
    EXPECT_LE(now, 253'000U) << spacing << " us apart";
  }
}

TEST_F(Guard, ASlowCrystalDoesNotSlowTheGait) {
  // The gait moves at the greatest speed, back and forth for a minute, by a clock that is 1,000 ppm slow.
  guard.command(0, 0);
  const std::int32_t step = MotionLimiter::step_of(default_command_speed, period_us);
  std::int32_t wanted = 0;
  for (int n = 1; n <= 20'000; ++n) {
    wanted += n / 25 % 2 == 0 ? step : -step;
    guard.command(static_cast<Microseconds>(n) * period_us * 999 / 1'000, wanted);
    ASSERT_EQ(guard.angle(), wanted) << "pulse " << n;
  }
}

TEST_F(Guard, SwitchedOffAndOnItBeginsAnywhereWithinTheLimits) {
  guard.set_limits(-quarter / 2, quarter / 2);
  guard.command(0, quarter);
  EXPECT_EQ(servo.widths.back(), 24'000);
  guard.off();
  EXPECT_FALSE(guard.is_pulsing());
  guard.command(100, -quarter);
  EXPECT_EQ(servo.widths.back(), 12'000);
  EXPECT_TRUE(guard.is_pulsing());
}

TEST_F(Guard, TheSafeAngleIsTheAllowedOneThatIsNearestToZero) {
  EXPECT_EQ(guard.safe_angle(), 0);
  guard.set_limits(100, 200);
  EXPECT_EQ(guard.safe_angle(), 100);
  guard.set_limits(-200, -100);
  EXPECT_EQ(guard.safe_angle(), -100);
}

TEST_F(Guard, NoSequenceOfRequestsBreaksABound) {
  constexpr std::uint64_t seed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Pcg32 random(seed, 0);
  guard.set_limits(-quarter / 3, quarter / 2);
  const std::int32_t step = MotionLimiter::step_of(default_command_speed, period_us);
  Microseconds now = 0;
  struct Pulse {
    Microseconds time;
    std::int32_t angle;
  };
  std::vector<Pulse> pulses;  // pulses since the servo was off
  for (int i = 0; i < 100'000; ++i) {
    now += random.below(4) == 0 ? random.below(20 * period_us) : random.below(2 * period_us);
    if (random.below(500) == 0) {
      guard.off();
      pulses.clear();
      continue;
    }
    guard.command(now, static_cast<std::int32_t>(random.next()));
    ASSERT_GE(guard.angle(), -quarter / 3);
    ASSERT_LE(guard.angle(), quarter / 2);
    pulses.push_back({now, guard.angle()});
    for (std::size_t back = 2; back <= std::min<std::size_t>(pulses.size(), 20); ++back) {
      const Pulse& earlier = pulses[pulses.size() - back];
      const double periods = static_cast<double>(now - earlier.time) / period_us * (1 + 1.0 / 63);
      ASSERT_LE(std::abs(double{1.0} * guard.angle() - earlier.angle), (periods + 2.5) * step) << "pulse " << i;
    }
  }
}

}  // namespace
}  // namespace proleg::firmware
