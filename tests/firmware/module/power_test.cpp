// The conditions under which the servo has pulses.

#include <cstdlib>

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using canopen::PowerState;
using test::node;

class Power : public testing::Test {
 protected:
  static constexpr std::uint32_t servo_us = 3'000;

  Power() { robot.set_up_and_start(); }

  void move() {
    robot.enable(0);
    robot.run(20);  // a fifth of a period of the sine
    ASSERT_TRUE(robot.it().is_pulsing());
    ASSERT_GT(std::abs(last_width() - servo_center), 1'000);
  }
  [[nodiscard]] std::int32_t last_width() { return *robot.it().pulses.back().width; }
  void expect_no_pulses(Microseconds time = 200'000) {
    const std::size_t pulses = robot.it().pulse_count();
    robot.bus.run_for(time);
    EXPECT_EQ(robot.it().pulse_count(), pulses);
    EXPECT_FALSE(robot.it().is_pulsing());
  }
  /// Expects that from now on the pulse moves to 0 degrees at 90 degrees a second, then stays.
  void expect_ramp_to_the_safe_pose() {
    std::vector<test::Pulse>& pulses = robot.it().pulses;
    std::int32_t width = last_width();
    std::size_t i = pulses.size();
    Microseconds time = 0;
    robot.bus.run_for(2'000'000);
    for (; i < pulses.size(); ++i) {
      ASSERT_TRUE(pulses[i].width) << "it holds";
      if (time != 0) {
        EXPECT_EQ(pulses[i].time - time, servo_us);
      }
      time = pulses[i].time;
      const std::int32_t step = servo_quarter_turn * (servo_us / 100) / 10'000;
      const std::int32_t way = *pulses[i].width - width;
      EXPECT_NEAR(std::abs(way), std::min(step, std::abs(width - servo_center)), 1);
      EXPECT_LT(std::abs(*pulses[i].width - servo_center), std::abs(width - servo_center));
      width = *pulses[i].width;
    }
    EXPECT_EQ(width, servo_center);
    EXPECT_TRUE(robot.it().is_pulsing());
  }

  test::TestModule robot{test::one_slot(test::algorithm(test::sinusoidal), 1), servo_us};
};

TEST_F(Power, IsOffFromPowerOnAndSwitchedOffOnce) {
  robot.run(20);
  ASSERT_EQ(robot.it().pulses.size(), 1U);
  EXPECT_FALSE(robot.it().pulses[0].width);
  EXPECT_EQ(robot.kernel().tick(), 21U) << "the state is still computed";
}

TEST_F(Power, PulsesNeedTheTickAndOperationEnabledAndOperational) {
  robot.enable(0);
  expect_no_pulses();  // there is no tick
  robot.tick(0);
  robot.sync(0);
  EXPECT_TRUE(robot.it().is_pulsing());
  robot.command(NmtCommand::enter_pre_operational);
  expect_no_pulses();
}

TEST_F(Power, PulsesStartInTheNextIntervalAfterTheServoWasEnabled) {
  robot.run(10);
  robot.sync(11);
  const Microseconds sync = robot.bus.now();
  robot.write_controlword(0x0006);
  robot.write_controlword(0x0007);
  robot.bus.run_until(sync + 4'000);
  robot.it().receive(sync + 4'000, encode(canopen::Command{node, 0x000F, 0}));
  EXPECT_EQ(robot.it().pulse_count(), 0U);
  robot.bus.run_until(sync + 9'800);
  // Tick 11 starts at 110 ms; intervals start at 111, 114 and 117 ms.
  ASSERT_EQ(robot.it().pulse_count(), 1U);
  EXPECT_EQ(robot.it().pulses.back().time, sync + 7'000);
}

TEST_F(Power, EveryOtherPowerStateIsOffAndSwitchesOffOnce) {
  for (const std::uint16_t word : std::to_array<std::uint16_t>({0x0000, 0x0006, 0x0007})) {
    test::TestModule other(robot.setup.kernel, servo_us);
    other.set_up_and_start();
    other.enable(0);
    other.run(20);
    ASSERT_TRUE(other.it().is_pulsing());
    other.write_controlword(word);
    EXPECT_FALSE(other.it().is_pulsing());
    const std::size_t commands = other.it().pulses.size();
    other.run(21, 60);
    EXPECT_EQ(other.it().pulses.size(), commands);
    EXPECT_EQ(other.kernel().tick(), 61U);
  }
}

TEST_F(Power, AQuickStopRampsToTheSafePoseWhileTicksContinue) {
  move();
  robot.write_controlword(0x0002);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  const std::uint32_t tick = robot.kernel().tick();
  robot.run(tick, tick + 5);
  EXPECT_EQ(robot.kernel().tick(), tick + 6);
  EXPECT_TRUE(robot.module().synchronised());
  expect_ramp_to_the_safe_pose();
}

TEST_F(Power, LostSyncRampsToTheSafePose) {
  move();
  robot.bus.run_for(495'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  expect_ramp_to_the_safe_pose();
}

TEST_F(Power, ALostTickRampsToTheSafePoseAndOnlyTheHostEndsThat) {
  move();
  robot.sync(40);
  EXPECT_FALSE(robot.module().synchronised());
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  expect_ramp_to_the_safe_pose();
  // The tick is known again: the joint is computed, and the servo holds.
  const std::size_t pulses = robot.it().pulse_count();
  robot.tick(300);
  robot.run(300, 310);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.it().pulse_count(), pulses);
  for (const std::uint16_t word : std::to_array<std::uint16_t>({0x0080, 0x0006, 0x0007, 0x000F})) {
    robot.write_controlword(word);
  }
  robot.run(311, 312);
  EXPECT_GT(robot.it().pulse_count(), pulses);
}

TEST_F(Power, WhoLeavesOperationalIsNotEnabledWhenItReturns) {
  for (const NmtCommand command : {NmtCommand::stop, NmtCommand::enter_pre_operational}) {
    test::TestModule other(robot.setup.kernel, servo_us);
    other.set_up_and_start();
    other.enable(0);
    other.run(20);
    ASSERT_TRUE(other.it().is_pulsing());
    other.command(command);
    EXPECT_EQ(other.module().power(), PowerState::switch_on_disabled);
    EXPECT_FALSE(other.it().is_pulsing());
    const std::size_t pulses = other.it().pulse_count();
    other.start();
    other.tick(0);
    other.run(0, 30);
    EXPECT_TRUE(other.module().synchronised());
    EXPECT_EQ(other.it().pulse_count(), pulses) << "no pulse without a controlword";
  }
}

TEST_F(Power, AQuickStopEndsWithOperational) {
  move();
  robot.write_controlword(0x0002);
  robot.bus.run_for(50'000);
  ASSERT_TRUE(robot.it().is_pulsing());
  robot.command(NmtCommand::enter_pre_operational);
  expect_no_pulses();
}

TEST_F(Power, AQuickStopEndsOnlyByDecision) {
  move();
  robot.write_controlword(0x0002);
  robot.bus.run_for(2'000'000);
  robot.write_controlword(0x000F);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  robot.write_controlword(0x0080);
  EXPECT_EQ(robot.module().power(), PowerState::switch_on_disabled);
  expect_no_pulses();
}

TEST_F(Power, AQuickStopOfAServoWithoutPulsesStaysOff) {
  robot.enable(0);
  robot.write_controlword(0x0002);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  expect_no_pulses(2'000'000);
}

TEST_F(Power, TheServoHasItsSupplyFromSwitchedOnToTheEndOfAQuickStop) {
  struct Step {
    std::uint16_t controlword;
    bool has_supply;
  };
  for (const Step step : std::to_array<Step>({{0x06, false},
                                              {0x07, true},
                                              {0x0F, true},
                                              {0x07, true},
                                              {0x06, false},
                                              {0x0F, true},
                                              {0x02, true},
                                              {0x80, false},
                                              {0x06, false},
                                              {0x0F, true},
                                              {0x00, false}})) {
    robot.write_controlword(step.controlword);
    EXPECT_EQ(robot.it().has_supply, step.has_supply) << step.controlword;
  }
  EXPECT_EQ(robot.it().supply_changes, 6U);
}

TEST_F(Power, TheServoLosesItsSupplyInAFault) {
  move();
  EXPECT_TRUE(robot.it().has_supply);
  robot.it().supply_low(robot.bus.now());
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().has_supply);
}

TEST_F(Power, TheServoLosesItsSupplyWithOperational) {
  for (const NmtCommand command :
       {NmtCommand::stop, NmtCommand::enter_pre_operational, NmtCommand::reset_node, NmtCommand::reset_communication}) {
    test::TestModule other(robot.setup.kernel, servo_us);
    other.set_up_and_start();
    other.enable(0);
    other.run(20);
    ASSERT_TRUE(other.it().has_supply);
    other.command(command);
    EXPECT_FALSE(other.it().has_supply);
  }
}

TEST(HostWatch, MissesNobodyBeforeTheFirstHeartbeatUnlessTheServoIsEnabled) {
  test::TestModule robot;
  robot.bus.host_is_alive = false;
  robot.set_up_and_start();
  robot.run(150);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST(HostWatch, AHostThatEnablesAServoAndDiesBeforeItsNextHeartbeatIsMissed) {
  test::TestModule robot;
  robot.bus.host_is_alive = false;
  robot.set_up_and_start();
  robot.enable(0);
  const Microseconds enabled = robot.bus.now();
  robot.run(43);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  robot.run(44, 60);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  EXPECT_LE(robot.bus.now(), enabled + 700'000);
  EXPECT_TRUE(robot.module().synchronised()) << "there are SYNCs";
}

TEST_F(Power, AMissingHostRampsToTheSafePose) {
  const CanFrame heartbeat = encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational});
  robot.enable(0);
  robot.bus.host_is_alive = false;
  robot.bus.deliver(heartbeat);
  robot.run(39);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  robot.bus.deliver(heartbeat);
  const Microseconds received = robot.bus.now();
  robot.run(40, 82);
  EXPECT_LT(robot.bus.now(), received + 450'000);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  robot.bus.run_until(received + 450'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  EXPECT_TRUE(robot.module().synchronised());
  robot.bus.run_for(1'000);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::heartbeat_lost, 0x11, canopen::host_node}));
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.emergencies().size(), 1U);
  // SYNC is back, and the quick stop stays.
  robot.bus.deliver(heartbeat);
  robot.bus.run_for(1'000);
  ASSERT_EQ(robot.emergencies().size(), 2U);
  EXPECT_EQ(robot.emergencies()[1].code, EmergencyCode::none);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
}

TEST_F(Power, OtherNodesHeartbeatsAreNotTheHosts) {
  robot.bus.deliver(encode(canopen::Heartbeat{12, canopen::NmtState::operational}));
  robot.bus.deliver({canopen::identifier::heartbeat + canopen::host_node, 2, {5, 0}});
  robot.bus.deliver({canopen::identifier::heartbeat + canopen::host_node, 1, {99}});
  robot.bus.run_for(2'000'000);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Power, ACommandByPdoSetsControlwordAndTarget) {
  for (const std::uint16_t word : test::power_up) {
    robot.bus.deliver(encode(canopen::Command{node, word, test::degrees(45)}));
  }
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_EQ(robot.bus.value(node, object::target_position), 0x20000000U);
  EXPECT_EQ(robot.bus.value(node, object::statusword) & 0x6FU, 0x27U);
  // The first command is for another node, the second has no angle.
  robot.bus.deliver(encode(canopen::Command{node + 1, 0, 0}));
  robot.bus.deliver(encode(canopen::Command{node, 0x000F, quarter_turn + 1}));
  EXPECT_EQ(robot.bus.value(node, object::target_position), 0x20000000U);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
}

TEST_F(Power, ACommandOfWrongLengthIsReportedOnceAndIgnored) {
  robot.enable(0);
  for (const std::uint8_t length : std::to_array<std::uint8_t>({0, 2, 5})) {
    robot.bus.deliver({canopen::identifier::command + node, length, {}});
  }
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0],
            (Emergency{node, EmergencyCode::wrong_length, 0, canopen::identifier::command + node}));
  robot.command(NmtCommand::enter_pre_operational);
  robot.start();
  robot.bus.deliver({canopen::identifier::command + node, 2, {}});
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.emergencies().size(), 2U) << "once after each start";
}

TEST_F(Power, OfALongerCommandTheMappedPartIsTaken) {
  for (const std::uint16_t word : test::power_up) {
    robot.bus.deliver(
        {canopen::identifier::command + node, 8, {static_cast<std::uint8_t>(word), 0, 0, 0, 0, 0x20, 1, 2}});
  }
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_EQ(robot.bus.value(node, object::target_position), 0x20000000U);
  robot.bus.run_for(1'000);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Power, WhatAQuickStopAndALostConnectionDoIsToldAndCannotBeChanged) {
  for (const canopen::Object* option : {&object::quick_stop_option, &object::abort_connection_option}) {
    EXPECT_EQ(robot.bus.value(node, *option), option->default_value);
    EXPECT_EQ(robot.bus.write(node, *option, option->default_value), AbortCode::none);
    EXPECT_EQ(robot.bus.write(node, *option, option->default_value - 1), AbortCode::below_minimum);
    EXPECT_EQ(robot.bus.write(node, *option, option->default_value + 1), AbortCode::above_maximum);
    EXPECT_EQ(robot.bus.value(node, *option), option->default_value);
  }
}

TEST_F(Power, ThePositionDemandIsTheSetPointOfTheTick) {
  move();
  EXPECT_EQ(robot.bus.value(node, object::position_demand), static_cast<std::uint32_t>(robot.kernel().setpoint(0)));
  robot.write(object::mode, canopen::mode_direct_position);
  robot.write(object::target_position, static_cast<std::uint32_t>(test::degrees(12)));
  robot.run(21, 21);
  EXPECT_EQ(robot.bus.value(node, object::position_demand), static_cast<std::uint32_t>(test::degrees(12)));
}

TEST_F(Power, CommandsByPdoCountInOperationalOnly) {
  robot.command(NmtCommand::enter_pre_operational);
  robot.bus.deliver(encode(canopen::Command{node, 0x0006, 77}));
  EXPECT_EQ(robot.module().power(), PowerState::switch_on_disabled);
  EXPECT_EQ(robot.bus.value(node, object::target_position), 0U);
}

TEST_F(Power, AJumpOfTheTargetBecomesARampWithinTheLimits) {
  robot.command(NmtCommand::enter_pre_operational);
  robot.write(object::upper_limit, static_cast<std::uint32_t>(test::degrees(30)));
  robot.write(object::command_speed, 300);
  robot.start();
  robot.write(object::mode, canopen::mode_direct_position);
  EXPECT_EQ(robot.bus.value(node, object::mode_display), 8U);
  robot.enable(0);
  robot.tick(0);
  robot.run(0, 5);
  const std::size_t from = robot.it().pulses.size();
  robot.write(object::target_position, static_cast<std::uint32_t>(test::degrees(80)));
  robot.run(6, 40);
  const std::vector<test::Pulse> pulses(robot.it().pulses.begin() + static_cast<std::ptrdiff_t>(from) - 1,
                                        robot.it().pulses.end());
  ASSERT_GT(pulses.size(), 100U);
  constexpr double degrees_per_pulse = 300 * 0.003;
  for (std::size_t i = 1; i < pulses.size(); ++i) {
    const double way = (*pulses[i].width - *pulses[i - 1].width) * 0.0075;
    EXPECT_GE(way, 0.0);
    EXPECT_LE(way, degrees_per_pulse + 0.0075);
  }
  EXPECT_EQ(*pulses.back().width, servo_command(test::degrees(30)));
  // 30 degrees take 0.1 s: 34 pulses of 3 ms, and one tick that the line takes.
  EXPECT_EQ(*pulses[38].width, servo_command(test::degrees(30)));
  EXPECT_LT(*pulses[30].width, servo_command(test::degrees(30)));
}

TEST_F(Power, AModeBeginsWhereTheServoIs) {
  robot.enable(0);
  robot.write(object::target_position, static_cast<std::uint32_t>(test::degrees(-70)));
  robot.run(20);
  robot.write(object::mode, canopen::mode_direct_position);
  EXPECT_EQ(robot.bus.value(node, object::target_position), static_cast<std::uint32_t>(robot.kernel().setpoint(0)))
      << "no earlier target counts";
  const std::int32_t held = servo_command(robot.kernel().setpoint(0));
  robot.run(21, 40);
  EXPECT_EQ(last_width(), held);
  // The joint returns to the gait, along a line of one tick if that is slow enough.
  robot.write(object::mode, static_cast<std::uint32_t>(canopen::mode_gait));
  robot.run(41, 60);
  EXPECT_NEAR(last_width(), servo_command(robot.kernel().setpoint(0)), 60);
}

TEST_F(Power, TheGreatestSpeedIsSetBeforeTheRobotMoves) {
  EXPECT_EQ(robot.bus.value(node, object::command_speed), 720U);
  EXPECT_EQ(robot.bus.write(node, object::command_speed, 100), AbortCode::refused_by_state);
  robot.command(NmtCommand::enter_pre_operational);
  EXPECT_EQ(robot.bus.write(node, object::command_speed, 89), AbortCode::below_minimum);
  EXPECT_EQ(robot.bus.write(node, object::command_speed, 10'001), AbortCode::above_maximum);
  EXPECT_EQ(robot.bus.write(node, object::command_speed, 10'000), AbortCode::none);
  EXPECT_EQ(robot.bus.value(node, object::command_speed), 10'000U);
}

}  // namespace
}  // namespace proleg
