#include "sim/loop/pulse_player.hpp"

#include <gtest/gtest.h>

namespace proleg::sim {
namespace {

TEST(ActingTime, IsTheStartOfTheIntervalExceptInTheLastMillisecondOfATick) {
  constexpr std::uint32_t tick_us = 10'000;
  for (const std::uint32_t servo_us : {1'000U, 3'300U, 20'000U}) {
    for (const std::uint64_t start_us : {0U, 1U, 5'000U, 9'000U, 10'000U, 19'000U}) {
      EXPECT_EQ(acting_time_us(start_us, servo_us, tick_us), start_us);
    }
    EXPECT_EQ(acting_time_us(9'001, servo_us, tick_us), 10'000U);
    EXPECT_EQ(acting_time_us(9'999, servo_us, tick_us), 10'000U);
    EXPECT_EQ(acting_time_us(19'900, servo_us, tick_us), 20'000U);
  }
}

TEST(ActingTime, FollowsTheOrderOfThePulses) {
  for (const std::uint32_t tick_us : {1'000U, 7'000U, 10'000U}) {
    for (const std::uint32_t servo_us : {100U, 700U, 981U, 3'300U}) {
      std::uint64_t before = 0;
      for (std::uint64_t start_us = 0; start_us < 50'000; start_us += servo_us) {
        const std::uint64_t acting = acting_time_us(start_us, servo_us, tick_us);
        EXPECT_GE(acting, before);
        EXPECT_GE(acting, start_us);
        EXPECT_LE(acting - start_us, 1'000U);
        before = acting;
      }
    }
  }
}

}  // namespace
}  // namespace proleg::sim
