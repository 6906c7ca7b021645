#include "shared/kernel/servo_pulses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace proleg {
namespace {

constexpr std::uint32_t periods_us[] = {100, 700, 999, 1'000, 3'000, 7'001, 10'000, 20'000, 25'000, 100'000};
constexpr std::uint32_t ticks_us[] = {1'000, 4'999, 10'000, 50'000, 131'071};

TEST(ServoSchedule, IntervalsFollowEachOtherFromTheStartWithoutGap) {
  for (const std::uint32_t period : periods_us) {
    const ServoSchedule schedule(period, 10'000);
    EXPECT_EQ(schedule.start_us(0), 0U);
    for (std::uint64_t n = 0; n < 1000; ++n) {
      EXPECT_EQ(schedule.start_us(n + 1) - schedule.start_us(n), period);
    }
  }
}

TEST(ServoSchedule, EveryIntervalBelongsToTheTickInWhichItStarts) {
  for (const std::uint32_t tick_us : ticks_us) {
    for (const std::uint32_t period : periods_us) {
      const ServoSchedule schedule(period, tick_us);
      EXPECT_EQ(schedule.first_interval(0), 0U);
      for (std::uint64_t tick = 0; tick < 300; ++tick) {
        for (std::uint64_t n = schedule.first_interval(tick); n < schedule.first_interval(tick + 1); ++n) {
          EXPECT_GE(schedule.start_us(n), tick * tick_us);
          EXPECT_LT(schedule.start_us(n), (tick + 1) * tick_us);
        }
      }
    }
  }
}

TEST(ServoSchedule, SamplesTheMiddleOfTheIntervalButNeverBeyondTheTick) {
  for (const std::uint32_t tick_us : ticks_us) {
    for (const std::uint32_t period : periods_us) {
      const ServoSchedule schedule(period, tick_us);
      for (std::uint64_t n = 0; n < 300; ++n) {
        const auto tick = static_cast<double>(schedule.start_us(n) / tick_us);
        const double middle = (static_cast<double>(n) + 0.5) * period / tick_us - tick;  // in ticks
        // Half a microsecond of an odd period and two steps of the fraction are rounded away.
        const double tolerance = 0.5 / tick_us + 2.0 / 65536.0 + 1e-12;
        EXPECT_NEAR(schedule.fraction(n) / 65536.0, std::min(middle, 1.0), tolerance)
            << "interval " << n << " of " << period << " us, tick of " << tick_us << " us";
      }
    }
  }
}

TEST(ServoSchedule, CountsFromTheSyncOfATickAsFromTheFirst) {
  for (const std::uint32_t tick_us : ticks_us) {
    for (const std::uint32_t period : periods_us) {
      const ServoSchedule schedule(period, tick_us);
      for (std::uint64_t tick = 0; tick < 300; ++tick) {
        const std::uint64_t interval = schedule.first_interval(tick);
        const std::uint32_t elapsed = schedule.first_start_us(tick);
        EXPECT_EQ(tick * tick_us + elapsed, schedule.start_us(interval));
        EXPECT_LT(elapsed, period);
        if (elapsed < tick_us) {
          EXPECT_EQ(schedule.fraction_at(elapsed), schedule.fraction(interval));
        }
      }
    }
  }
}

TEST(ServoSchedule, DoesNotDriftOverADay) {
  const ServoSchedule schedule(700, 10'000);
  constexpr std::uint64_t ticks_a_day = 8'640'000;
  // 7 ticks are 100 intervals.
  EXPECT_EQ(schedule.first_interval(7 * 1'234'285), 100U * 1'234'285);
  EXPECT_EQ(schedule.start_us(schedule.first_interval(ticks_a_day)), 86'400'000'400U);
  EXPECT_EQ(schedule.fraction(100'000'000'003), schedule.fraction(3));
}

}  // namespace
}  // namespace proleg
