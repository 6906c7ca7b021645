// A crystal or a PLL that does not start or stops: what the program does at the pins and on the bus.

#include <gtest/gtest.h>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

class ClockFailure : public testing::Test {
 protected:
  explicit ClockFailure(const RigSettings& settings = {}) : rig_(settings) {
    rig_.chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
      is_high_ = high;
      last_edge_ = time;
    });
  }

  [[nodiscard]] bool prints(const std::string& words) const {
    return rig_.board.console.find(words) != std::string::npos;
  }
  [[nodiscard]] std::size_t resets(ResetCause cause) const {
    std::size_t count = 0;
    for (const ChipEvent& event : rig_.events) {
      count += event.kind == ChipEvent::Kind::reset && event.cause == cause ? 1U : 0U;
    }
    return count;
  }
  /// The crystal stops 100 us after the begin of a pulse; returns when.
  BusTime stop_in_a_pulse() {
    rig_.start_robot(20'000);
    rig_.enable_servo(0);
    rig_.run_for(50 * ms);
    EXPECT_TRUE(rig_.run_until_true([this] { return !is_high_; }));
    EXPECT_TRUE(rig_.run_until_true([this] { return is_high_; }));
    rig_.run_for(100 * us);
    EXPECT_TRUE(is_high_);
    rig_.chip.set_crystal(false);
    return rig_.bus.now();
  }
  void expect_silence_and_restarts(const std::string& words) {
    rig_.run_for(20 * ms);
    EXPECT_TRUE(prints("proleg module: " + words + "\r\n"));
    const BusTime start = rig_.bus.now();
    const std::size_t before = resets(ResetCause::independent_watchdog);
    rig_.run_for(1'000 * ms);
    EXPECT_NEAR(static_cast<double>(resets(ResetCause::independent_watchdog) - before), 4.5, 1)
        << "200 ms, and 20 for the attempt";
    EXPECT_TRUE(rig_.log.empty() || rig_.log.back().time < start);
    EXPECT_FALSE(is_high_);
    EXPECT_LE(last_edge_, start);
  }
  /// With a clock again: it boots and reports why it had restarted.
  void expect_report() {
    const BusTime start = rig_.bus.now();
    ASSERT_TRUE(rig_.run_until_true([&] { return !rig_.frames(0x083, start).empty(); }, 400 * ms));
    EXPECT_EQ(rig_.frames(0x703, start).size(), 1U);
    EXPECT_EQ(emergency_code(rig_.frames(0x083, start)[0]), 0x5220U);
    rig_.run_for(30 * ms);
    EXPECT_TRUE(prints("started by clock failure\r\n"));
  }

  ChipRig rig_;
  bool is_high_ = false;
  BusTime last_edge_ = 0;
};

TEST_F(ClockFailure, ACrystalThatStopsInAPulseResetsTheModuleWhenThePulseIsOver) {
  const BusTime stopped = stop_in_a_pulse();
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, 3 * ms));
  EXPECT_FALSE(is_high_);
  EXPECT_GT(last_edge_, stopped + ms) << "the pulse of 1.5 ms ends at its own width: last_pulse_test.cpp";
  EXPECT_EQ(rig_.events[0].kind, ChipEvent::Kind::reset);
  EXPECT_EQ(rig_.events[0].cause, ResetCause::software);
  EXPECT_LE(rig_.events[0].time, last_edge_ + 100 * us);
}

TEST_F(ClockFailure, ACrystalThatStopsBetweenPulsesResetsTheModuleAtOnce) {
  rig_.start_robot(20'000);
  const BusTime stopped = rig_.bus.now();
  rig_.chip.set_crystal(false);
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, ms));
  EXPECT_EQ(rig_.events[0].kind, ChipEvent::Kind::reset);
  EXPECT_LE(rig_.events[0].time, stopped + 100 * us);
  EXPECT_EQ(last_edge_, 0U) << "there was no pulse";
}

TEST_F(ClockFailure, ACrystalThatStopsAtAnyInstantOfTheStartIsRecorded) {
  // From the lock of the PLL on, the program starts one peripheral after the other.
  for (BusTime running = 2 * ms; running < 4 * ms; running += 50 * us) {
    ChipRig rig;
    rig.power_on();
    rig.run_for(running);
    rig.chip.set_crystal(false);
    rig.run_for(100 * ms);
    for (const ChipEvent& event : rig.events) {
      EXPECT_EQ(event.kind, ChipEvent::Kind::reset) << running << " ns after power on: " << event.text;
    }
    EXPECT_NE(rig.board.console.find("the crystal does not start"), std::string::npos) << running;
  }
}

TEST_F(ClockFailure, ACrystalThatStopsIsRecordedAndTheModuleIsSilentUntilItRunsAgain) {
  stop_in_a_pulse();
  rig_.run_for(100 * ms);
  EXPECT_TRUE(prints("stopped by: the crystal has stopped, pc 0"));
  expect_silence_and_restarts("the crystal does not start");
  rig_.chip.set_crystal(true);
  expect_report();
}

TEST_F(ClockFailure, ACrystalThatStopsForAShortTimeIsReportedWithThePlaceInTheProgram) {
  stop_in_a_pulse();
  rig_.run_for(ms);
  rig_.chip.set_crystal(true);
  expect_report();
  EXPECT_TRUE(prints("started by clock failure\r\nstopped by: the crystal has stopped, pc 08"));
  EXPECT_FALSE(is_high_);
}

TEST_F(ClockFailure, ACrystalThatNeverStartsIsReportedAndTheWatchdogTriesAgain) {
  rig_.chip.set_crystal(false);
  rig_.power_on();
  rig_.run_for(200 * ms);
  expect_silence_and_restarts("the crystal does not start");
  rig_.chip.set_crystal(true);
  expect_report();
}

TEST_F(ClockFailure, APllThatNeverLocksIsReportedAndTheWatchdogTriesAgain) {
  rig_.chip.set_pll(false);
  rig_.power_on();
  rig_.run_for(200 * ms);
  expect_silence_and_restarts("the PLL does not lock");
  rig_.chip.set_pll(true);
  expect_report();
}

TEST_F(ClockFailure, APllThatLosesItsLockEndsThePulsesAndResetsTheModule) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(50 * ms);
  rig_.chip.set_pll(false);
  const BusTime failed = rig_.bus.now();
  // 20 ms of a clock that is a third slower, and a pulse.
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, 30 * ms));
  EXPECT_EQ(rig_.events[0].kind, ChipEvent::Kind::reset);
  EXPECT_EQ(rig_.events[0].cause, ResetCause::software);
  rig_.run_for(100 * ms);
  EXPECT_LE(last_edge_, failed + 30 * ms);
  EXPECT_TRUE(prints("stopped by: the PLL has lost its lock, pc 08"));
  expect_silence_and_restarts("the PLL does not lock");
  rig_.chip.set_pll(true);
  expect_report();
}

TEST_F(ClockFailure, APllThatLosesItsLockForAMomentIsReported) {
  rig_.start_robot(20'000);
  rig_.chip.set_pll(false);
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, 70 * ms));
  rig_.chip.set_pll(true);
  expect_report();
}

TEST_F(ClockFailure, AnNmiThatIsNotFromTheClockSecuritySystemIsAnotherFault) {
  rig_.boot();
  rig_.chip.cpu().set_non_maskable(true);
  rig_.chip.cpu().set_non_maskable(false);
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, 300 * ms));
  EXPECT_EQ(rig_.events[0].cause, ResetCause::software);
  rig_.run_for(50 * ms);
  EXPECT_TRUE(prints("started by fault\r\nstopped by: non-maskable interrupt, pc 08"));
}

/// As close as 50 ns to the bus, so that the PLL can fail between its lock and the switch to it.
class LatePll : public ClockFailure {
 protected:
  static constexpr BusTime step = 50;
  LatePll() : ClockFailure(settings()) {}
  static RigSettings settings() {
    RigSettings settings;
    settings.max_lead = step;
    return settings;
  }
};

TEST_F(LatePll, ThatLosesItsLockBeforeTheSwitchAndLocksLaterGetsNoBusWithoutPrescaler) {
  // The core runs at 16 MHz until the switch, then at 168 MHz.
  rig_.power_on();
  rig_.run_for(ms);
  for (std::uint64_t executed = 0; executed < 100;) {
    ASSERT_LT(rig_.bus.now(), 10 * ms);
    executed = rig_.chip.instructions();
    rig_.run_for(us);
    executed = rig_.chip.instructions() - executed;
  }
  const BusTime switched = rig_.bus.now();
  std::size_t not_switched = 0;
  for (BusTime early = 200; early < 6 * us; early += 200) {
    ChipRig rig(settings());
    rig.power_on();
    rig.run_until(switched - early);
    rig.chip.set_pll(false);
    rig.run_for(15 * ms);  // the program has given up
    rig.chip.set_pll(true);
    rig.run_for(400 * ms);
    for (const ChipEvent& event : rig.events) {
      EXPECT_EQ(event.kind, ChipEvent::Kind::reset) << early << " ns before: " << event.text;
    }
    EXPECT_EQ(rig.frames(0x703).size(), 1U) << "it boots after a watchdog reset";
    not_switched += rig.board.console.find("the PLL does not lock") != std::string::npos ? 1U : 0U;
  }
  EXPECT_GT(not_switched, 0U);
}

}  // namespace
}  // namespace proleg::sim
