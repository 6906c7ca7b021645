// The chip's supply: the voltage detector stops the servo, and a brown-out reset is a start like after power on.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

class Supply : public testing::Test {
 protected:
  explicit Supply(const RigSettings& settings = {}) : rig_(settings) {
    rig_.chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
      is_high_ = high;
      last_edge_ = time;
    });
    rig_.start_robot(20'000);
    rig_.enable_servo(0);
    rig_.run_for(100 * ms);
    EXPECT_LT(rig_.bus.now(), last_edge_ + 25 * ms) << "it gives pulses";
    EXPECT_TRUE(rig_.frames(0x083).empty());
  }
  /// The supply falls or rises by 0.1 V a millisecond, as it does in a fault schedule.
  void ramp_to(std::uint32_t mv) {
    while (supply_mv_ != mv) {
      supply_mv_ = mv > supply_mv_ ? std::min(supply_mv_ + 20, mv) : std::max(supply_mv_ - 20, mv);
      rig_.chip.set_supply(supply_mv_);
      rig_.run_for(200 * us);
    }
  }
  void expect_that_the_program_has_always_followed_the_supply() const {
    for (const ChipEvent& event : rig_.events) {
      EXPECT_EQ(event.kind, ChipEvent::Kind::reset) << event.text;
    }
  }
  [[nodiscard]] bool prints(const std::string& words) const {
    return rig_.board.console.find(words) != std::string::npos;
  }
  [[nodiscard]] std::vector<unsigned> codes() const {
    std::vector<unsigned> found;
    for (const LoggedFrame& frame : rig_.frames(0x083)) {
      found.push_back(emergency_code(frame));
    }
    return found;
  }

  ChipRig rig_;
  bool is_high_ = false;
  BusTime last_edge_ = 0;

 private:
  std::uint32_t supply_mv_ = 3'300;
};

TEST_F(Supply, ThatFallsFasterThanTheProgramCanFollowStopsTheModelWithItsReason) {
  rig_.chip.set_supply(2'150);
  EXPECT_TRUE(rig_.events.empty()) << "7 wait states";
  rig_.chip.set_supply(2'050);
  rig_.run_for(ms);
  ASSERT_EQ(rig_.events.size(), 1U);
  EXPECT_EQ(rig_.events[0].kind, ChipEvent::Kind::unmodelled);
  EXPECT_EQ(rig_.events[0].text, "HCLK of 168 MHz at 2.05 V: at most 160 MHz (RM0090, table 10)");
}

/// Option bytes as delivered: there is no brown-out reset. The servo moves; then the supply falls to this voltage.
class FallingSupply : public Supply, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(FallingSupply, EndsTheProgramBeforeItsClockIsTooFast) {
  const bool ends = GetParam() < 2'600;
  const BusTime falls = rig_.bus.now();
  ramp_to(GetParam());
  rig_.run_for(500 * ms);
  EXPECT_LT(last_edge_, falls + 8 * ms) << "3.3 V to 2.93 V takes 3.7 ms";
  EXPECT_FALSE(is_high_);
  EXPECT_EQ(prints("proleg module: the supply voltage is too low\r\n"), ends);
  EXPECT_EQ(rig_.log.back().time < rig_.bus.now() - 400 * ms, ends) << "silent";

  const BusTime rises = rig_.bus.now();
  ramp_to(3'300);
  rig_.run_for(500 * ms);
  EXPECT_EQ(rig_.frames(0x703, rises).size(), ends ? 1U : 0U) << "it boots again";
  EXPECT_LT(last_edge_, rises) << "the host decides";
  expect_that_the_program_has_always_followed_the_supply();
}

INSTANTIATE_TEST_SUITE_P(Millivolts, FallingSupply, testing::Values(2'700, 2'560, 2'400, 2'200, 2'100, 1'900, 1'690));

TEST_F(Supply, BelowTheThresholdThereIsNoFurtherPulse) {
  rig_.chip.set_supply(2'940);
  rig_.run_for(50 * ms);
  EXPECT_TRUE(codes().empty()) << "above 2.93 V";
  // The moment before a pulse is the worst one.
  ASSERT_TRUE(rig_.run_until_true([this] { return is_high_; }));
  ASSERT_TRUE(rig_.run_until_true([this] { return !is_high_; }));
  rig_.run_until(last_edge_ + 18'400 * us);
  const BusTime dropped = rig_.bus.now();
  rig_.chip.set_supply(2'900);
  rig_.run_for(300 * ms);
  EXPECT_LT(last_edge_, dropped);
  ASSERT_EQ(codes(), std::vector<unsigned>{0x3220});
  EXPECT_LT(rig_.frames(0x083)[0].time, dropped + ms);
  EXPECT_NE(rig_.frames(0x183).back().frame.data[6] & 0x10U, 0U) << "state frame: fault";
}

TEST_F(Supply, ThatIsGoodAgainIsReportedAndTheServoStaysOffUntilItIsEnabled) {
  rig_.chip.set_supply(2'900);
  rig_.run_for(100 * ms);
  rig_.chip.set_supply(3'020);
  rig_.run_for(100 * ms);
  EXPECT_EQ(codes(), std::vector<unsigned>{0x3220}) << "hysteresis";
  rig_.chip.set_supply(3'300);
  rig_.run_for(100 * ms);
  EXPECT_EQ(codes(), (std::vector<unsigned>{0x3220, 0}));
  EXPECT_LT(last_edge_, rig_.bus.now() - 200 * ms);
  rig_.write(0x6040, 0, 2, 0x80);
  rig_.enable_servo(0);
  rig_.run_for(100 * ms);
  EXPECT_LT(rig_.bus.now(), last_edge_ + 25 * ms);
}

TEST_F(Supply, ADropThatEndsBeforeTheProgramLooksIsAFaultToo) {
  rig_.chip.set_supply(2'900);
  rig_.chip.set_supply(3'300);
  rig_.run_for(100 * ms);
  EXPECT_EQ(codes(), (std::vector<unsigned>{0x3220, 0}));
  EXPECT_LT(last_edge_, rig_.bus.now() - 70 * ms);
}

TEST_F(Supply, WithoutABrownOutLevelThePowerDownResetComesAndMemoryIsLost) {
  ramp_to(1'690);
  rig_.run_for(10 * ms);
  ramp_to(1'660);
  rig_.run_for(100 * ms);
  EXPECT_FALSE(is_high_);
  const BusTime start = rig_.bus.now();
  rig_.run_for(500 * ms);
  EXPECT_TRUE(rig_.log.back().time < start) << "it is held in reset";
  const std::size_t before = rig_.events.size();
  ramp_to(3'300);
  rig_.run_for(500 * ms);
  ASSERT_GT(rig_.events.size(), before);
  EXPECT_EQ(rig_.events[before].cause, ResetCause::power_on);
  EXPECT_EQ(rig_.frames(0x703, start).size(), 1U);
  expect_that_the_program_has_always_followed_the_supply();
}

TEST_F(Supply, ThatIsTooLowAtTheStartKeepsTheProgramFromTheFullClock) {
  ramp_to(2'300);
  rig_.power_on();
  const BusTime start = rig_.bus.now();
  rig_.run_for(1'000 * ms);
  expect_that_the_program_has_always_followed_the_supply();
  EXPECT_TRUE(rig_.frames(0x703, start).empty());
  ramp_to(3'300);
  rig_.run_for(500 * ms);
  EXPECT_EQ(rig_.frames(0x703, start).size(), 1U);
  EXPECT_TRUE(rig_.frames(0x083, start).empty());
}

/// Option bytes BOR_LEV = 0: level 3, which docs/board.md asks for.
class BrownOut : public Supply {
 protected:
  BrownOut() : Supply(settings()) {}
  static RigSettings settings() {
    RigSettings settings;
    settings.chip.brown_out_level = 0;
    return settings;
  }
};

TEST_F(BrownOut, ResetsTheChipAtItsLevelAndTheNextStartIsLikePowerOn) {
  rig_.chip.set_supply(2'840);
  rig_.run_for(10 * ms);
  EXPECT_TRUE(rig_.events.empty());
  const std::size_t printed = rig_.board.console.size();
  const BusTime start = rig_.bus.now();
  rig_.chip.set_supply(2'820);
  rig_.run_for(500 * ms);
  EXPECT_TRUE(rig_.events.empty()) << "held";
  EXPECT_TRUE(rig_.log.back().time <= start + ms);
  EXPECT_FALSE(is_high_);
  rig_.chip.set_supply(2'910);
  rig_.run_for(100 * ms);
  EXPECT_TRUE(rig_.events.empty()) << "hysteresis";
  rig_.chip.set_supply(3'300);
  rig_.run_for(100 * ms);
  ASSERT_EQ(rig_.events.size(), 1U);
  EXPECT_EQ(rig_.events[0].cause, ResetCause::brown_out);
  EXPECT_NE(rig_.board.console.find("started by power on\r\n", printed), std::string::npos);
  EXPECT_EQ(rig_.frames(0x703, start + ms).size(), 1U);
}

TEST_F(BrownOut, ASupplyThatIsStillLowAtTheStartIsReportedAfterTheBootUpMessage) {
  rig_.chip.set_supply(2'820);
  rig_.run_for(10 * ms);
  const BusTime start = rig_.bus.now();
  rig_.chip.set_supply(2'925);
  rig_.run_for(100 * ms);
  ASSERT_EQ(rig_.frames(0x703, start).size(), 1U);
  ASSERT_EQ(rig_.frames(0x083, start).size(), 1U);
  EXPECT_EQ(emergency_code(rig_.frames(0x083, start)[0]), 0x3220U);
  EXPECT_GT(rig_.frames(0x083, start)[0].time, rig_.frames(0x703, start)[0].time);
}

}  // namespace
}  // namespace proleg::sim
