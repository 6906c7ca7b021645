// The bounds of commanded angles. Oracle: the definition in degrees and seconds, in double precision.

#include "shared/kernel/servo_pulses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shared/fixed/random.hpp"

namespace proleg {
namespace {

constexpr double step_per_degree = 1073741824.0 / 90.0;  // 2^30

TEST(MotionLimiter, AStepIsWhatTheSpeedAllowsInAPeriodAndNotMore) {
  for (const std::uint32_t speed : {min_command_speed, 100U, 257U, default_command_speed, 9'999U, max_command_speed}) {
    for (const std::uint32_t period_us : {100U, 700U, 1'000U, 3'000U, 20'000U, 99'999U, 100'000U}) {
      const double exact = speed * (period_us * 1e-6) * step_per_degree;
      const double step = MotionLimiter::step_of(speed, period_us);
      EXPECT_LE(step, exact) << speed << " degrees/s, " << period_us << " us";
      EXPECT_GT(step, std::min(exact, 2147483647.0) - 1.0) << speed << " degrees/s, " << period_us << " us";
    }
  }
}

TEST(MotionLimiter, TheFirstAngleMayBeAnywhereWithinTheLimits) {
  MotionLimiter limiter;
  limiter.set_step(1);
  limiter.set_limits(-500, 700);
  EXPECT_EQ(limiter.next(600), 600);
  limiter.release();
  EXPECT_EQ(limiter.next(-20'000), -500);
  limiter.release();
  EXPECT_EQ(limiter.next(-500), -500);
}

TEST(MotionLimiter, LeavesSlowMotionAsItIs) {
  constexpr std::uint32_t period_us = 3'000;
  MotionLimiter limiter;
  const std::int32_t step = MotionLimiter::step_of(300, period_us);
  limiter.set_step(step);
  for (int i = -20; i <= 20; ++i) {
    ASSERT_EQ(limiter.next(i * step), i * step) << "exactly the greatest speed";
  }
}

TEST(MotionLimiter, FollowsAJumpAtTheGreatestSpeedAndReachesIt) {
  constexpr std::uint32_t period_us = 20'000;
  MotionLimiter limiter;
  limiter.set_step(MotionLimiter::step_of(720, period_us));
  constexpr auto far = static_cast<std::int32_t>(60 * step_per_degree);
  EXPECT_EQ(limiter.next(-far), -far);
  int periods = 0;
  for (std::int32_t before = -far; limiter.next(far) != far; before = limiter.angle()) {
    ASSERT_NEAR(limiter.angle() - before, 14.4 * step_per_degree, 1.0);
    ++periods;
  }
  EXPECT_EQ(periods, 8) << "120 degrees take 0.167 s";
}

TEST(MotionLimiter, KeepsBothBoundsForAnyAngles) {
  constexpr std::uint64_t seed = 20;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Pcg32 random(seed, 0);
  MotionLimiter limiter;
  std::int32_t lower = -(1 << 30);
  std::int32_t upper = 1 << 30;
  std::int32_t step = MotionLimiter::step_of(default_command_speed, 20'000);
  for (int i = 0; i < 200'000; ++i) {
    if (random.below(1'000) == 0) {
      limiter.release();
      step = static_cast<std::int32_t>(random.below(1U << 31U));
      limiter.set_step(step);
      lower = static_cast<std::int32_t>(random.below(1U << 30U)) - (1 << 30);
      upper = lower + static_cast<std::int32_t>(random.below(1U << 30U));
      limiter.set_limits(lower, upper);
    }
    const bool is_first = limiter.is_released();
    const std::int64_t before = limiter.angle();
    const auto wanted = static_cast<std::int32_t>(random.next());
    const std::int64_t angle = limiter.next(wanted);
    ASSERT_GE(angle, lower);
    ASSERT_LE(angle, upper);
    if (!is_first) {
      ASSERT_LE(std::abs(angle - before), step);
      const bool is_there = angle == limiter.within_limits(wanted);
      ASSERT_TRUE(is_there || std::abs(angle - before) == step) << "no slower than it must";
    }
  }
}

TEST(MotionLimiter, AnAngleOutsideNewLimitsReturnsAtTheGreatestSpeed) {
  MotionLimiter limiter;
  limiter.set_step(100);
  EXPECT_EQ(limiter.next(1'000), 1'000);
  limiter.set_limits(-50, 850);
  EXPECT_EQ(limiter.next(2'000), 900);
  EXPECT_EQ(limiter.next(2'000), 850);
}

TEST(MotionLimiter, DoesNotOverflow) {
  MotionLimiter limiter;
  limiter.set_step(std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(limiter.next(std::numeric_limits<std::int32_t>::min()), -(1 << 30));
  EXPECT_EQ(limiter.next(std::numeric_limits<std::int32_t>::max()), (1 << 30) - 1);
}

}  // namespace
}  // namespace proleg
