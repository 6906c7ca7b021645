// Faults that take the pulses from the servo: too much current, a chip that is too hot, sensors that give no new
// readings, a supply voltage that is too low.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::PowerState;
using test::node;

/// The servo is enabled.
class ServoFault : public testing::Test {
 protected:
  ServoFault() {
    robot.set_up_and_start();
    robot.enable(0);
  }
  [[nodiscard]] ServoReadings& readings() { return robot.it().meters.readings; }

  test::TestModule robot;
};

/// The servo is enabled and follows the gait, and tick 10 is the next.
class RunningServoFault : public ServoFault {
 protected:
  RunningServoFault() {
    robot.run(9);
    EXPECT_TRUE(robot.it().is_pulsing());
  }
};

// A servo that draws too much for too long loses its pulses.
class OverCurrent : public ServoFault {
 protected:
  void draw(std::uint16_t current_ma) { readings().current_ma = current_ma; }
  /// Runs SYNCs up to and including `last`. Returns whether the module is in Fault then.
  bool faulty_after(std::uint32_t first, std::uint32_t last) {
    robot.run(first, last);
    return robot.module().power() == PowerState::fault;
  }
  [[nodiscard]] std::uint8_t flags(std::uint32_t tick) const {
    for (const test::TestBus::Sent& sent : robot.bus.sent(canopen::identifier::state_frame + node)) {
      if (sent.frame.data[7] == static_cast<std::uint8_t>(tick)) {
        return sent.frame.data[6];
      }
    }
    ADD_FAILURE() << "no state " << tick;
    return 0;
  }
};

TEST_F(OverCurrent, IsAFaultAfterHalfASecondAbove2000MilliamperesAndNotATickSooner) {
  robot.run(9);
  draw(2'001);
  // The first reading above the limit is that of tick 10; half a second is 50 ticks of 10 ms.
  EXPECT_FALSE(faulty_after(10, 59));
  EXPECT_TRUE(robot.it().is_pulsing());
  EXPECT_TRUE(robot.emergencies().empty());
  robot.sync(60);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  EXPECT_EQ(robot.bus.value(node, object::statusword) & 0x4FU, 0x08U) << "CiA 402: fault";
}

TEST(ServoWithoutCurrentSensor, IsNotGuardedByItsCurrentAndTheModuleSaysSo) {
  test::TestBus bus;
  firmware::ModuleIdentity identity;
  identity.node = 3;
  identity.board_id = 3;
  identity.capabilities = canopen::has_no_current_sensor;
  test::ModuleNode& module = bus.add(identity);
  module.power_on(0);
  module.meters.readings.current_ma = 30'000;  // noise of a pin without a sensor
  bus.run_until(2'000'000);
  EXPECT_EQ(bus.value(3, object::capabilities) & canopen::has_no_current_sensor, canopen::has_no_current_sensor);
  EXPECT_EQ(bus.value(3, object::actual_current), 0U);
  EXPECT_EQ(bus.value(3, object::error_register), 0U);
}

TEST(ServoWithoutCurrentSensor, IsNotInFaultAboveTheLimit) {
  struct Meter final : firmware::SensorPort {
    ServoReadings take_readings() override {
      ServoReadings readings;
      readings.current_ma = 30'000;
      return readings;
    }
  } meter;
  firmware::ServoMonitor with_sensor(meter, true);
  firmware::ServoMonitor without_sensor(meter, false);
  for (firmware::ServoMonitor* const monitor : {&with_sensor, &without_sensor}) {
    monitor->reset({});
    for (Microseconds now = 0; now <= 1'000'000; now += 10'000) {
      monitor->read(now, 10'000);
    }
  }
  EXPECT_TRUE(with_sensor.over_current());
  EXPECT_FALSE(without_sensor.over_current());
  EXPECT_EQ(without_sensor.current_ma(), 0U);
}

TEST_F(OverCurrent, UpToTheLimitIsNone) {
  draw(2'000);
  robot.run(0);
  EXPECT_FALSE(faulty_after(1, 300));
}

TEST_F(OverCurrent, AReadingAtTheLimitDoesNotHideTheAverage) {
  draw(30'000);
  robot.run(49);
  draw(2'000);
  EXPECT_TRUE(faulty_after(50, 50));
}

TEST_F(OverCurrent, ThatIsPulsedCountsWithItsMean) {
  robot.tick(0);
  for (std::uint32_t tick = 0; tick < 50; ++tick) {
    draw(tick % 2 == 0 ? 4'100 : 0);
    EXPECT_FALSE(faulty_after(tick, tick)) << tick;
  }
  draw(4'100);
  EXPECT_TRUE(faulty_after(50, 50)) << "2,050 mA for half a second";
}

TEST_F(OverCurrent, WhoseAverageFallsToTheLimitRestartsItsTime) {
  draw(2'100);
  robot.run(19);
  draw(0);
  robot.run(20, 20);  // twenty readings are 100 mA above the limit, and one is 2,000 mA below
  draw(2'100);
  EXPECT_FALSE(faulty_after(21, 70));
  EXPECT_TRUE(faulty_after(71, 71));
}

TEST_F(OverCurrent, LimitAndTimeAreObjects) {
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x200A, 1}), 2'000U);
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x200A, 2}), 500U);
  robot.write(object::current_limit, 700);
  robot.write(object::current_limit_time, 35);
  draw(701);
  robot.run(3);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled) << "30 ms after the first reading";
  EXPECT_TRUE(faulty_after(4, 4));
}

TEST_F(OverCurrent, TimeZeroIsTheFirstReading) {
  robot.write(object::current_limit_time, 0);
  robot.run(0);
  draw(2'001);
  EXPECT_TRUE(faulty_after(1, 1));
}

TEST_F(OverCurrent, LimitZeroIsOff) {
  robot.write(object::current_limit, 0);
  draw(0xFFFF);
  robot.run(0);
  EXPECT_FALSE(faulty_after(1, 200));
}

TEST_F(OverCurrent, LimitsDoNotBelongToTheConfiguration) {
  const std::uint32_t crc = robot.bus.value(node, object::configuration_crc);
  EXPECT_EQ(crc, robot.crc());
  robot.write(object::current_limit, 1);
  robot.write(object::current_limit_time, 2);
  EXPECT_EQ(robot.bus.value(node, object::configuration_crc), crc);
  robot.command(canopen::NmtCommand::enter_pre_operational);
  robot.configure(0);
  EXPECT_EQ(robot.bus.value(node, object::configuration_crc), crc);
  EXPECT_EQ(robot.bus.value(node, object::current_limit), 1U) << "a new set-up of the gait leaves them";
  robot.command(canopen::NmtCommand::reset_node);
  robot.bus.run_for(50'000);
  EXPECT_EQ(robot.bus.value(node, object::current_limit), 2'000U);
}

TEST_F(OverCurrent, IsReportedWithTheDocumentedFrame) {
  // docs/protocol.md shows the message for node 3.
  const CanFrame example{0x083, 8, {0x10, 0x23, 0x03, 0, 0, 0, 0, 0}};
  draw(5'000);
  robot.run(50);
  robot.bus.run_for(1'000);
  std::vector<test::TestBus::Sent> sent = robot.bus.sent(canopen::identifier::emergency + node);
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].frame.data, example.data);
  EXPECT_EQ(robot.bus.value(node, object::error_register), 0x03U);
}

TEST_F(OverCurrent, SetsTheFaultFlagOfTheStateFramesAndNothingElse) {
  test::TestModule sound(robot.setup.kernel);
  sound.set_up_and_start();
  draw(5'000);
  robot.run(80);
  sound.run(80);
  ASSERT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_EQ(flags(51) & StateFrame::fault, 0) << "sent before the reading of its tick";
  EXPECT_EQ(flags(52) & StateFrame::fault, StateFrame::fault);
  EXPECT_EQ(flags(81) & StateFrame::fault, StateFrame::fault);
  EXPECT_EQ(robot.kernel().setpoint(0), sound.kernel().setpoint(0)) << "the state is still computed";
  StateFrame frame = robot.kernel().frame(0, 0);
  frame.bytes[6] = static_cast<std::uint8_t>(frame.bytes[6] & ~unsigned{StateFrame::fault});
  EXPECT_EQ(frame, sound.kernel().frame(0, 0));
  EXPECT_EQ(robot.module().last_tick().flags & StateFrame::fault, StateFrame::fault);
}

TEST_F(OverCurrent, EndsByDecision) {
  draw(5'000);
  robot.run(50);
  draw(100);
  robot.run(51, 150);
  EXPECT_EQ(robot.module().power(), PowerState::fault) << "also when the current is gone";
  robot.write_controlword(0x000F);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  const std::size_t before = robot.bus.log.size();
  robot.write_controlword(0x0080);
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.module().power(), PowerState::switch_on_disabled);
  EXPECT_EQ(robot.emergencies(before), (std::vector{Emergency{node, EmergencyCode::none, 0, 0x2310}}));
  robot.run(151, 152);
  EXPECT_EQ(flags(153) & StateFrame::fault, 0);
  robot.enable(0);
  robot.run(153, 154);
  EXPECT_TRUE(robot.it().is_pulsing());
}

TEST_F(OverCurrent, ThatContinuesAfterTheDecisionIsAFaultAgainAfterItsTime) {
  draw(5'000);
  robot.run(60);
  ASSERT_EQ(robot.module().power(), PowerState::fault);
  robot.write_controlword(0x0080);
  EXPECT_EQ(robot.emergencies().size(), 2U);
  EXPECT_FALSE(faulty_after(61, 110));
  EXPECT_TRUE(faulty_after(111, 111));
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.emergencies().size(), 3U) << "reported again";
}

TEST_F(OverCurrent, IsSeenInAServoThatHoldsTheSafePoseWithoutSync) {
  robot.run(20);
  draw(5'000);
  robot.bus.run_for(510'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active) << "SYNC was lost before half a second was over";
  robot.bus.run_for(40'000);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
}

TEST_F(OverCurrent, CurrentIsReadOnceATickAfterTheStateFrame) {
  robot.run(9);
  const std::size_t before = robot.it().meters.count;
  robot.run(10, 59);
  EXPECT_EQ(robot.it().meters.count, before + 50);
}

TEST_F(OverCurrent, AFaultOutlastsTheEndOfOperational) {
  draw(5'000);
  robot.run(50);
  robot.command(canopen::NmtCommand::enter_pre_operational);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  robot.start();
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  robot.run(1);
  EXPECT_EQ(robot.kernel().frame(0, 0).flags() & StateFrame::fault, StateFrame::fault);
}

// The program and the measurements of a chip that is too hot cannot be trusted for long.
class OverTemperature : public RunningServoFault {
 protected:
  void heat(std::int8_t temperature_c) { readings().temperature_c = temperature_c; }
};

TEST_F(OverTemperature, IsAFaultAtTheNextReading) {
  heat(94);
  robot.run(10, 20);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  heat(95);
  robot.run(21, 22);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  // CiA 301: 4210, device temperature. Error register: generic, temperature.
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::over_temperature, 0x09, 0}}));
}

TEST_F(OverTemperature, LastsUntilTheChipIsTenDegreesCoolerAndTheHostClearsTheFault) {
  heat(120);
  robot.run(10, 11);
  for (const std::int8_t temperature : {std::int8_t{94}, std::int8_t{85}}) {
    heat(temperature);
    robot.run(robot.kernel().tick(), robot.kernel().tick() + 2);
    robot.write_controlword(0x0080);
    EXPECT_EQ(robot.module().power(), PowerState::fault);
    robot.write_controlword(0x0000);
  }
  heat(84);
  robot.run(robot.kernel().tick(), robot.kernel().tick() + 2);
  EXPECT_EQ(robot.emergencies().back(), (Emergency{node, EmergencyCode::none, 0, 0x4210}));
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  robot.write_controlword(0x0080);
  robot.enable(0);
}

// Without new readings over-current would not be noticed.
class StaleSensors : public RunningServoFault {
 protected:
  void stall() { readings().are_new = false; }
  void work() { readings().are_new = true; }
};

TEST_F(StaleSensors, AreAFaultAtTheFifthReadingAndNotSooner) {
  stall();
  robot.run(10, 13);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_TRUE(robot.emergencies().empty());
  robot.run(14, 14);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  // CiA 402: 5210, measurement circuit. Error register: generic, device profile.
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::sensors_failed, 0x21, 0}}));
}

TEST_F(StaleSensors, ForAShorterTimeAreNone) {
  for (std::uint32_t tick = 10; tick < 60; tick += 5) {
    stall();
    robot.run(tick, tick + 3);
    work();
    robot.run(tick + 4, tick + 4);
  }
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(StaleSensors, KeepTheFaultUntilTheyMeasureAndAHostClearsIt) {
  stall();
  robot.run(10, 14);
  robot.write_controlword(0x0080);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  work();
  robot.run(15, 16);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_EQ(robot.emergencies().size(), 2U);
  EXPECT_EQ(robot.emergencies().back(), (Emergency{node, EmergencyCode::none, 0, 0x5210}));
  robot.write_controlword(0x0000);
  robot.write_controlword(0x0080);
  robot.enable(0);
}

TEST_F(StaleSensors, DoNotAddToTheTimeOfAnOverCurrent) {
  robot.it().meters.readings.current_ma = 5'000;
  robot.run(10, 57);
  stall();
  robot.run(58, 61);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled) << "48 readings above the limit";
}

class Supply : public RunningServoFault {
 protected:
  void drop() { robot.it().supply_low(robot.bus.now()); }
  void recover() { robot.it().supply_good(robot.bus.now()); }
};

TEST_F(Supply, ThatIsTooLowStopsThePulsesAtOnceAndIsReported) {
  drop();
  EXPECT_FALSE(robot.it().is_pulsing());
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  robot.bus.run_for(1'000);
  // CiA 402: 3220. Error register: generic, voltage (CiA 301, 7.5.2.2).
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0}}));
  drop();
  robot.run(10, 20);
  EXPECT_EQ(robot.emergencies().size(), 1U) << "reported once";
  EXPECT_EQ(robot.kernel().tick(), 21U) << "the gait is computed";
}

TEST_F(Supply, ThatIsTooLowKeepsTheFaultWhateverTheHostCommands) {
  drop();
  for (const std::uint16_t controlword : std::array<std::uint16_t, 4>{0x0080, 0x0006, 0x0007, 0x000F}) {
    robot.write_controlword(controlword);
    EXPECT_EQ(robot.module().power(), PowerState::fault);
  }
  robot.run(10, 20);
  EXPECT_FALSE(robot.it().is_pulsing());
}

TEST_F(Supply, ThatIsGoodAgainIsReportedAndPulsesNeedADecision) {
  drop();
  robot.run(10, 12);
  recover();
  robot.run(13, 20);
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0},
                                              Emergency{node, EmergencyCode::none, 0, 0x3220}}));
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  robot.write_controlword(0x0080);
  robot.enable(0);
  robot.run(21, 22);
  EXPECT_TRUE(robot.it().is_pulsing());
}

TEST_F(Supply, ThatIsTooLowDuringAResetOfTheNodeIsReportedAfterTheBootUpMessage) {
  drop();
  robot.bus.run_for(1'000);
  const std::size_t before = robot.bus.log.size();
  robot.command(canopen::NmtCommand::reset_node);
  robot.bus.run_for(50'000);
  EXPECT_EQ(robot.emergencies(before), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0}}));
  const auto boot_up = robot.bus.sent(canopen::identifier::heartbeat + node, before);
  const auto emergency = robot.bus.sent(canopen::identifier::emergency + node, before);
  ASSERT_EQ(boot_up.size(), 1U);
  EXPECT_LT(boot_up[0].time, emergency[0].time);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
}

TEST(SupplyAtTheStart, ThatRisesBeforeTheBootUpMessageIsNoFault) {
  test::TestModule robot;
  robot.it().power_on(0);
  robot.it().supply_low(10);
  robot.it().supply_good(20);
  robot.bus.run_for(50'000);
  EXPECT_EQ(robot.bus.sent(canopen::identifier::heartbeat + node).size(), 1U);
  EXPECT_TRUE(robot.emergencies().empty());
  EXPECT_EQ(robot.module().power(), PowerState::switch_on_disabled);
}

}  // namespace
}  // namespace proleg
