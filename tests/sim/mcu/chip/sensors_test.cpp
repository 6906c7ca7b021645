// Switches at PB12 to PB15, voltages at the ADC, the temperature sensor: what the module reports of them on the bus.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned current_channel = 10;
constexpr unsigned feedback_channel = 11;
constexpr BusTime ten_ticks = 100 * ms;

struct Monitored {
  std::int16_t angle;
  unsigned current_ma;
  std::int8_t temperature;
  std::uint8_t errors;
};

Monitored monitored(ChipRig& rig) {
  rig.run_for(2 * ten_ticks + 20 * ms);
  const std::vector<LoggedFrame> frames = rig.frames(0x383);
  EXPECT_FALSE(frames.empty());
  const CanFrame frame = frames.empty() ? CanFrame{} : frames.back().frame;
  EXPECT_EQ(frame.length, 6);
  const auto& data = frame.data;
  return {static_cast<std::int16_t>(data[0] | data[1] << 8), static_cast<unsigned>(data[2] | data[3] << 8),
          static_cast<std::int8_t>(data[4]), data[5]};
}

TEST(TouchPins, EachCombinationIsInTheStateFrame) {
  ChipRig rig;
  rig.start_robot(20'000);
  for (unsigned closed = 0; closed < 16; ++closed) {
    rig.board.low_pins_of_b = static_cast<std::uint16_t>(closed << 12U);
    rig.run_for(45 * ms);
    const std::vector<LoggedFrame> states = rig.frames(0x183);
    ASSERT_FALSE(states.empty());
    EXPECT_EQ(states.back().frame.data[6] & 0x0FU, closed);
  }
}

TEST(TouchPins, OtherPinsOfThePortDoNotMatter) {
  ChipRig rig;
  rig.start_robot(20'000);
  rig.board.low_pins_of_b = 0x0CFF;
  rig.run_for(50 * ms);
  EXPECT_EQ(rig.frames(0x183).back().frame.data[6] & 0x0FU, 0U);
}

TEST(Readings, CurrentIsMonitoredWithinOnePercentOrOneMilliampereOrOneCode) {
  constexpr double code_ma = 3'300.0 / 4'096;
  ChipRig rig;
  rig.board.temperature = 31'000;
  rig.start_robot(20'000);
  for (const unsigned ma : {0U, 1U, 7U, 50U, 350U, 999U, 1'999U, 3'299U}) {
    rig.board.uv[current_channel] = ma * 1'000;
    const Monitored found = monitored(rig);
    EXPECT_NEAR(found.current_ma, ma, std::max({1.0, code_ma, 0.01 * ma}));
    EXPECT_EQ(found.angle, -32'768) << "no potentiometer";
    EXPECT_NEAR(found.temperature, 31, 1);
    EXPECT_EQ(found.errors, 0);
  }
}

TEST(Readings, TemperatureIsMonitoredWithinOneDegree) {
  ChipRig rig;
  rig.start_robot(20'000);
  for (const int degrees : {-40, -10, 0, 30, 85, 105}) {
    rig.board.temperature = degrees * 1'000;
    EXPECT_NEAR(monitored(rig).temperature, degrees, 1);
  }
}

TEST(Readings, ThePotentiometerIsReadByTheBoardsOwnCalibration) {
  RigSettings settings;
  settings.record = firmware::BoardRecord{3, true, 612, 3490};
  ChipRig rig(settings);
  rig.start_robot(20'000);
  for (const double degrees : {-90.0, -44.0, 0.0, 10.0, 90.0}) {
    const double code = 612 + (degrees + 90) / 180 * (3'490 - 612);
    rig.board.uv[feedback_channel] = static_cast<std::uint32_t>((code + 0.5) * 3'300'000 / 4'096);
    // A code is 180 degrees / 2878; 90 degrees are 2^14.
    EXPECT_NEAR(monitored(rig).angle * 90.0 / 16'384, degrees, 180.0 / 2'878);
  }
}

TEST(Readings, OfAnAdcThatHangsAreAFaultAfterFiveTicksAndTheServoGetsNoPulse) {
  ChipRig rig;
  BusTime last_edge = 0;
  rig.chip.set_pin_watch('A', 5, [&](BusTime time, bool /*high*/) { last_edge = time; });
  rig.start_robot(20'000);
  rig.enable_servo(0);
  rig.run_for(100 * ms);
  rig.chip.set_adc(false);
  const BusTime hung = rig.bus.now();
  rig.run_for(300 * ms);
  std::vector<LoggedFrame> emergencies = rig.frames(0x083);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergency_code(emergencies[0]), 0x5210U);
  EXPECT_EQ(emergencies[0].frame.data[2], 0x21U) << "error register: generic, device profile";
  // The conversion of the tick before may be done; then five ticks.
  EXPECT_GE(emergencies[0].time, hung + 40 * ms);
  EXPECT_LE(emergencies[0].time, hung + 70 * ms);
  EXPECT_LT(last_edge, emergencies[0].time + 3 * ms);
  EXPECT_NE(rig.frames(0x183).back().frame.data[6] & 0x10U, 0U) << "state frame: fault";
  rig.write(0x6040, 0, 2, 0x80);
  EXPECT_EQ(rig.read(0x6041, 0) & 0x4FU, 0x08U) << "still Fault";

  rig.chip.set_adc(true);
  rig.run_for(50 * ms);
  emergencies = rig.frames(0x083);
  ASSERT_EQ(emergencies.size(), 2U);
  EXPECT_EQ(emergency_code(emergencies[1]), 0U);
  EXPECT_LT(last_edge, hung + 70 * ms) << "it needs a decision";
  rig.write(0x6040, 0, 2, 0x00);
  rig.write(0x6040, 0, 2, 0x80);
  rig.enable_servo(0);
  rig.run_for(50 * ms);
  EXPECT_LT(rig.bus.now(), last_edge + 25 * ms);
}

/// The servo works; then `fail` stops the conversions once, for no longer than a moment.
void expect_that_readings_come_back(const std::function<void(ChipRig&)>& fail) {
  ChipRig rig;
  BusTime last_edge = 0;
  rig.chip.set_pin_watch('A', 5, [&](BusTime time, bool /*high*/) { last_edge = time; });
  rig.start_robot(20'000);
  rig.enable_servo(0);
  rig.board.uv[current_channel] = 200'000;
  rig.run_for(100 * ms);
  fail(rig);
  rig.run_for(300 * ms);
  EXPECT_TRUE(rig.frames(0x083).empty()) << "two readings without new values are no fault";
  EXPECT_GT(last_edge + 25 * ms, rig.bus.now()) << "it gives pulses";
  rig.board.uv[current_channel] = 700'000;
  EXPECT_NEAR(monitored(rig).current_ma, 700, 7);
}

TEST(Readings, ComeBackAfterAnOverrunOfTheAdc) {
  expect_that_readings_come_back([](ChipRig& rig) {
    rig.chip.set_adc(false);
    rig.run_for(ms);
    rig.chip.set_adc(true);
  });
}

TEST(Readings, ComeBackAfterATransferErrorOfTheDma) {
  expect_that_readings_come_back([](ChipRig& rig) { rig.chip.fail_dma_of_adc(); });
}

class OverCurrent : public testing::Test {
 protected:
  OverCurrent() {
    rig_.chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
      is_high_ = high;
      last_edge_ = time;
    });
    rig_.start_robot(20'000);
    rig_.write(0x200A, 1, 2, 500);
    rig_.write(0x200A, 2, 2, 100);
    rig_.enable_servo(0);
    rig_.run_for(100 * ms);
  }
  ChipRig rig_;
  bool is_high_ = false;
  BusTime last_edge_ = 0;
};

TEST_F(OverCurrent, SwitchesThePulsesOffAfterItsTimeAndSaysSo) {
  const BusTime start = rig_.bus.now();
  rig_.board.uv[current_channel] = 800'000;
  rig_.run_for(400 * ms);
  const std::vector<LoggedFrame> emergencies = rig_.frames(0x083);
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergency_code(emergencies[0]), 0x2310U);
  // The conversion of the tick before is read: 1 to 2 ticks, and one more to be above for all of the time.
  EXPECT_GE(emergencies[0].time, start + 100 * ms);
  EXPECT_LE(emergencies[0].time, start + 131 * ms);
  EXPECT_FALSE(is_high_);
  EXPECT_LE(last_edge_, emergencies[0].time);
  EXPECT_NE(rig_.frames(0x183).back().frame.data[6] & 0x10U, 0U) << "state frame: fault";
  EXPECT_NE(monitored(rig_).errors & 1U, 0U);
}

/// The current is high for a part of each tick: `from` to `to` after the SYNC.
class PulsedCurrent : public OverCurrent {
 protected:
  void draw(std::uint32_t ma, BusTime from, BusTime to) {
    const BusTime sync = rig_.frames(0x080).back().time;
    rig_.board.voltage = [this, ma, from, to, sync](unsigned channel) {
      const BusTime since = (rig_.board.clock() - sync) % (10 * ms);
      return channel == current_channel && since >= from && since < to ? ma * 1'000 : 0U;
    };
    rig_.board.next_change = [this, from, to, sync] {
      const BusTime now = rig_.board.clock();
      const BusTime start = now - (now - sync) % (10 * ms);
      const BusTime since = now - start;
      return start + (since < from ? from : since < to ? to : 10 * ms + from);
    };
  }
};

TEST_F(PulsedCurrent, InStepWithTheTicksIsSeen) {
  draw(1'000, 2 * ms, 8 * ms);
  rig_.run_for(400 * ms);
  ASSERT_EQ(rig_.frames(0x083).size(), 1U) << "600 mA";
  EXPECT_EQ(emergency_code(rig_.frames(0x083)[0]), 0x2310U);
  EXPECT_NEAR(monitored(rig_).current_ma, 600, 30) << "40 samples of 1,000 mA or 0";
}

TEST_F(PulsedCurrent, CountsWithItsMeanAndNotWithItsPeak) {
  draw(3'000, 0, ms);
  rig_.run_for(400 * ms);
  EXPECT_TRUE(rig_.frames(0x083).empty()) << "300 mA";
  EXPECT_NEAR(monitored(rig_).current_ma, 300, 90);
}

TEST(SamplesOfTheCurrent, AreNoEventsOfAChipThatSleeps) {
  ChipRig rig;
  rig.boot();
  // A sample comes every 239 us; the program wakes at least every 50 ms.
  EXPECT_TRUE(rig.run_until_true([&] { return rig.chip.next_event() > rig.bus.now() + 10 * ms; }));
}

TEST_F(OverCurrent, AtTheLimitOrForAShorterTimeIsNone) {
  rig_.board.uv[current_channel] = 499'000;
  rig_.run_for(400 * ms);
  for (unsigned i = 0; i < 5; ++i) {
    rig_.board.uv[current_channel] = 600'000;
    rig_.run_for(80 * ms);
    rig_.board.uv[current_channel] = 100'000;
    rig_.run_for(40 * ms);
  }
  EXPECT_TRUE(rig_.frames(0x083).empty());
  EXPECT_GT(last_edge_ + 25 * ms, rig_.bus.now());
}

}  // namespace
}  // namespace proleg::sim
