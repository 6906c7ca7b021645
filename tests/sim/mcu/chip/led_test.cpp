// What the LED shows, at its pin: the table in docs/first-board.md.

#include <gtest/gtest.h>

#include <string>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

/// A board with its LED (docs/first-board.md; the reference board: docs/board.md). All are on when their pin is high.
struct Led {
  std::string folder;  ///< of its images, below that of the reference board
  std::uint32_t crystal;
  char port;
  unsigned pin;
};

/// What a person sees in a time in which every pattern repeats.
struct Seen {
  static constexpr BusTime duration = 3'200 * ms;
  unsigned flashes = 0;  ///< in `duration`; one that has begun before counts, too
  double on_ms = 0;
};

class StatusLed : public testing::TestWithParam<Led> {
 protected:
  explicit StatusLed(const std::string& image = "proleg_stm32f405")
      : rig_({.image = GetParam().folder + image,
              .chip = {{0x0123'4567, 0x89AB'CDEF, 0x5A5A'0F0F}, 0, 1, 3, GetParam().crystal}}) {
    rig_.chip.set_pin_watch(GetParam().port, GetParam().pin, [this](BusTime time, bool high) {
      if (is_on_ && !high) {
        on_ += time - since_;
      }
      flashes_ += high && !is_on_ ? 1U : 0U;
      is_on_ = high;
      since_ = time;
    });
  }
  /// Looks for Seen::duration. A new state shows within 50 ms.
  Seen look() {
    rig_.run_for(60 * ms);
    since_ = rig_.bus.now();
    on_ = 0;
    flashes_ = is_on_ ? 1U : 0U;
    rig_.run_for(Seen::duration);
    return {flashes_, static_cast<double>(on_ + (is_on_ ? rig_.bus.now() - since_ : 0)) / ms};
  }
  void command(std::uint8_t nmt) { rig_.host.send({0x000, 2, {nmt, 0}}); }

  ChipRig rig_;

 private:
  bool is_on_ = false;
  BusTime since_ = 0;
  BusTime on_ = 0;
  unsigned flashes_ = 0;
};

constexpr double bit_ms = 50 + 1;  ///< a pattern consists of bits of 50 ms

TEST_P(StatusLed, BlinksTwoAndAHalfTimesASecondInPreOperational) {
  rig_.boot();
  const Seen seen = look();
  EXPECT_NEAR(seen.flashes, 8U, 1);
  EXPECT_NEAR(seen.on_ms, 1'600, bit_ms);
}

TEST_P(StatusLed, FlashesOnceEvery1600MillisecondsInStopped) {
  rig_.boot();
  command(0x02);
  const Seen seen = look();
  EXPECT_NEAR(seen.flashes, 2U, 1);
  EXPECT_NEAR(seen.on_ms, 2 * 200, bit_ms);
}

TEST_P(StatusLed, IsOnInOperational) {
  rig_.start_robot(20'000);
  EXPECT_EQ(look().on_ms, 3'200);
}

TEST_P(StatusLed, FlashesTwiceEvery1600MillisecondsWhileTheDriveIsInFault) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.board.temperature = 120'000;  // thousandths of a degree
  rig_.run_for(200 * ms);
  const Seen seen = look();
  EXPECT_NEAR(seen.flashes, 4U, 1);
  EXPECT_NEAR(seen.on_ms, 4 * 200, bit_ms);
}

class StatusLedOfBootloader : public StatusLed {
 protected:
  StatusLedOfBootloader() : StatusLed("proleg_boot_stm32f405") {}
};

TEST_P(StatusLedOfBootloader, FlickersTenTimesASecond) {
  rig_.power_on();
  rig_.run_for(500 * ms);
  const Seen seen = look();
  EXPECT_NEAR(seen.flashes, 32U, 1);
  EXPECT_NEAR(seen.on_ms, 1'600, bit_ms);
}

const auto boards =
    testing::Values(Led{"", 8'000'000, 'C', 6}, Led{"olimex-stm32-p405/", 8'000'000, 'C', 12},
                    Led{"weact-stm32f405/", 8'000'000, 'B', 2}, Led{"feather-stm32f405/", 12'000'000, 'C', 1});
std::string name_of(const testing::TestParamInfo<Led>& tested) {
  return std::string(1, tested.param.port) + std::to_string(tested.param.pin);
}
INSTANTIATE_TEST_SUITE_P(Boards, StatusLed, boards, name_of);
INSTANTIATE_TEST_SUITE_P(Boards, StatusLedOfBootloader, boards, name_of);

}  // namespace
}  // namespace proleg::sim
