// Pulses along a line, also when SYNC or the processor's time does not come as it should.

#include "firmware/module/servo_driver.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "servo_recorder.hpp"

namespace proleg::firmware {
namespace {

class Driver : public testing::Test {
 protected:
  static constexpr std::int32_t quarter = 1 << 30;
  static constexpr std::int32_t line = quarter / 8;
  static constexpr std::int32_t line_end = 18'000 + 12'000 / 8;

  /// A line takes 11.25 degrees in 10 ms.
  Driver() {
    driver.guard().set_command_speed(max_command_speed);
    driver.configure({1'000, 10'000});
  }
  /// The pulse in the middle of interval n of a tick that moves from 0 to `line`, with the fraction of
  /// docs/protocol.md.
  static std::int32_t pulse(std::uint32_t n) {
    const std::uint32_t fraction = 2 * (((n * 1'000 + 500) << 15U) / 10'000);
    return 18'000 + static_cast<std::int32_t>((std::uint64_t{12'000 / 8} * fraction + 32'768) / 65'536);
  }

  test::ServoRecorder servo;
  ServoDriver driver{servo};
  std::vector<std::optional<std::int32_t>>& pulses = servo.widths;
};

TEST_F(Driver, TakesEveryIntervalInTime) {
  driver.follow();
  driver.start_tick(500, 7, 0, line);
  for (std::uint32_t n = 1; n < 10; ++n) {
    ASSERT_EQ(driver.next_deadline(), 500U + n * 1'000);
    driver.poll(driver.next_deadline());
  }
  EXPECT_EQ(driver.next_deadline(), never);
  ASSERT_EQ(pulses.size(), 10U);
  for (std::uint32_t n = 0; n < 10; ++n) {
    EXPECT_EQ(pulses[n], pulse(n));
  }
}

TEST_F(Driver, SaysHowOftenAPulseIsToBeRepeated) {
  driver.configure({3'000, 10'000});
  driver.follow();
  driver.start_tick(0, 0, quarter, quarter);
  EXPECT_EQ(servo.period_us, 3'000U);
  servo.period_us = 0;
  driver.quick_stop(0);
  driver.poll(driver.next_deadline());
  EXPECT_EQ(servo.period_us, 3'000U) << "on the way to the safe pose, too, which is held";
}

TEST_F(Driver, CalledTooLateTakesTheLatestIntervalOnly) {
  driver.follow();
  driver.start_tick(500, 7, 0, line);
  driver.poll(500 + 4'999);
  ASSERT_EQ(pulses.size(), 2U);
  EXPECT_EQ(pulses[1], pulse(4));
  EXPECT_EQ(driver.next_deadline(), 5'500U);
  driver.poll(1'000'000'000'000);
  ASSERT_EQ(pulses.size(), 3U);
  EXPECT_EQ(pulses[2], pulse(9));
  EXPECT_EQ(driver.next_deadline(), never);
}

TEST_F(Driver, ASyncThatIsEarlyLosesNoInterval) {
  driver.follow();
  driver.start_tick(0, 7, 0, line);
  driver.poll(8'000);
  driver.start_tick(8'950, 8, line, line);
  ASSERT_EQ(pulses.size(), 4U);
  EXPECT_EQ(pulses[2], pulse(9));
  EXPECT_EQ(pulses[3], line_end);
}

TEST_F(Driver, AnIntervalOfATickBeforeItFollowedIsNotMadeUpFor) {
  driver.start_tick(0, 7, 0, line);
  driver.follow();
  driver.start_tick(500, 8, line, line);
  ASSERT_EQ(pulses.size(), 1U);
  EXPECT_EQ(pulses[0], line_end);
}

TEST_F(Driver, ATickMayHaveNoInterval) {
  driver.configure({25'000, 10'000});
  driver.follow();
  driver.start_tick(0, 0, 0, line);
  EXPECT_EQ(pulses.size(), 1U);
  EXPECT_EQ(driver.next_deadline(), never);
  driver.start_tick(10'000, 1, 0, line);
  EXPECT_EQ(driver.next_deadline(), never);
  driver.start_tick(20'000, 2, 0, line);
  EXPECT_EQ(driver.next_deadline(), 25'000U);
}

TEST_F(Driver, ARampThatIsCalledTooLateDoesNotHurry) {
  driver.follow();
  driver.start_tick(0, 0, quarter, quarter);
  driver.quick_stop(100);
  EXPECT_EQ(driver.next_deadline(), 1'100U);
  driver.poll(70'000);
  ASSERT_EQ(pulses.size(), 2U);
  EXPECT_NEAR(*pulses[1], 30'000 - 12, 1);
  EXPECT_EQ(driver.next_deadline(), 71'000U);
}

TEST_F(Driver, RampsFromEitherSideToTheSafePoseAndHolds) {
  for (const std::int32_t side : {quarter, -quarter}) {
    driver.reset();
    driver.follow();
    driver.start_tick(0, 0, side, side);
    driver.quick_stop(0);
    pulses.clear();
    while (driver.next_deadline() != never) {
      driver.poll(driver.next_deadline());
      ASSERT_LE(pulses.size(), 1'001U);
    }
    EXPECT_NEAR(static_cast<double>(pulses.size()), 1'000, 1) << "90 degrees in a second";
    EXPECT_EQ(pulses.back(), 18'000);
  }
}

TEST_F(Driver, RampsToTheLimitThatIsNearestToZero) {
  driver.guard().set_limits(quarter / 9, quarter / 3);  // 10 to 30 degrees
  driver.follow();
  driver.start_tick(0, 0, quarter / 3, quarter / 3);
  driver.quick_stop(0);
  while (driver.next_deadline() != never) {
    driver.poll(driver.next_deadline());
    ASSERT_LE(pulses.size(), 1'001U);
    EXPECT_GE(*pulses.back(), servo_command(quarter / 9));
  }
  EXPECT_EQ(pulses.back(), servo_command(quarter / 9));
}

TEST_F(Driver, GoesOnWithTheNextIntervalWhenItIsSwitchedOffAndOn) {
  driver.follow();
  driver.start_tick(0, 0, 0, line);
  driver.stop();
  driver.poll(1'000);
  driver.follow();
  driver.poll(2'000);
  ASSERT_EQ(pulses.size(), 3U);
  EXPECT_EQ(pulses[1], std::nullopt);
  EXPECT_EQ(pulses[2], pulse(2));
}

TEST_F(Driver, AQuickStopBeforeTheFirstPulseStaysOff) {
  driver.start_tick(0, 0, 0, line);
  driver.follow();
  driver.quick_stop(500);
  driver.poll(1'000);
  ASSERT_EQ(pulses.size(), 1U);
  EXPECT_EQ(pulses[0], std::nullopt);
}

TEST_F(Driver, AResetForgetsTheLine) {
  driver.start_tick(0, 0, 0, line);
  driver.reset();
  EXPECT_EQ(driver.next_deadline(), never);
}

TEST_F(Driver, IsSilentUntilItFollows) {
  driver.start_tick(0, 0, 0, line);
  driver.quick_stop(10);
  driver.poll(5'000);
  driver.stop();
  EXPECT_TRUE(pulses.empty());
}

}  // namespace
}  // namespace proleg::firmware
