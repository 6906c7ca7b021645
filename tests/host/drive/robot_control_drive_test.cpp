// Scenarios on robots behind plug-ins: emulated bus servos on virtual time and behind a pseudo terminal, and the
// example of docs/robot-control.md. The expected goal positions are those of `simulate`, converted with integers.

#include "tools/proleg/robot/robot_control_drive.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "servo_run.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/simulation.hpp"
#include "tests/host/dynamixel/pty_servos.hpp"
#include "tests/support/message_of.hpp"

namespace proleg {
namespace {

using host::DriveResult;
using test::EmulatedServo;
using test::ServoEmulator;

/// 4096 steps a turn, 90 degrees = 2^30: nearest, ties up.
std::int32_t position_of(std::int32_t setpoint) { return 2048 + ((setpoint + (1 << 19)) >> 20); }

TEST_F(ServoRun, TheGoalsOfFiveSecondsAreTheSetpointsOfSimulate) {
  for (const std::string name : {"uniform", "coupled"}) {
    const sim::Scenario scenario = shipped_gait(name);
    constexpr std::uint32_t ticks = 500;
    servos = ServoEmulator(5);
    std::vector<std::size_t> first_goals;  // of the gait, for each servo; the ramp has others before
    RobotControlDrive options;
    options.ticks = ticks;
    options.observer = [&](const host::GaitDriver::Tick& tick) {
      for (std::size_t joint = 0; tick.number == 0 && joint < 5; ++joint) {
        first_goals.push_back(servos.servos[joint].goals.size() - 1);
      }
    };
    const DriveResult result = drive(scenario, options);
    ASSERT_FALSE(result.failure) << *result.failure;
    EXPECT_EQ(result.gait_ticks, ticks);
    EXPECT_EQ(result.late_ticks, 0U);
    ASSERT_EQ(first_goals.size(), 5U);

    std::vector<std::vector<std::int32_t>> expected(5);
    sim::Simulation simulation(scenario);
    for (std::uint32_t tick = 0; tick < ticks; ++tick) {
      simulation.advance();
      for (std::size_t joint = 0; joint < 5; ++joint) {
        expected[joint].push_back(position_of(simulation.setpoints()[joint]));
      }
    }
    for (std::size_t joint = 0; joint < 5; ++joint) {
      std::vector<std::int32_t> sent;
      const std::vector<EmulatedServo::Goal>& goals = servos.servos[joint].goals;
      for (std::size_t i = first_goals[joint]; i < goals.size() && sent.size() < ticks; ++i) {
        EXPECT_TRUE(goals[i].has_power);
        sent.push_back(goals[i].position);
      }
      EXPECT_EQ(sent, expected[joint]) << name << " joint " << joint;
    }
    expect_ramped_down();
    EXPECT_EQ(servos.bad_instructions, 0U);
  }
}

TEST_F(ServoRun, NothingMovesBeforeAllServosHaveAnswered) {
  servos.servo(5).is_missing = true;
  RobotControlDrive options;
  options.ticks = 10;
  const std::string error =
      message_of<host::RobotControlError>([&] { static_cast<void>(drive(shipped_gait("uniform"), options)); });
  EXPECT_NE(error.find("servo 5 (joint J1) does not answer"), std::string::npos) << error;
  EXPECT_FALSE(any_has_power());
  for (const EmulatedServo& servo : servos.servos) {
    EXPECT_TRUE(servo.goals.empty());
  }
}

TEST_F(ServoRun, AServoThatFailsInTheRunIsNamedAndTheOthersRampDown) {
  RobotControlDrive options;
  options.ticks = 500;
  options.observer = [this](const host::GaitDriver::Tick& tick) { servos.servo(2).is_missing = tick.number >= 100; };
  const DriveResult result = drive(shipped_gait("uniform"), options);
  EXPECT_EQ(result.failure,
            "plug-in 'dynamixel': servo 2 (joint J4) has not answered 3 times in a row; check its cable and its power");
  EXPECT_LE(result.gait_ticks, 105U);
  expect_ramped_down(2);
}

TEST_F(ServoRun, AHardwareErrorInTheRunIsNamedAndTheOthersRampDown) {
  RobotControlDrive options;
  options.ticks = 500;
  options.observer = [this](const host::GaitDriver::Tick& tick) {
    if (tick.number == 100) {
      servos.servo(3).fail(0x04);
    }
  };
  const DriveResult result = drive(shipped_gait("uniform"), options);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find("servo 3 (joint J3) has a hardware error: overheating"), std::string::npos);
  expect_ramped_down(3);
}

TEST_F(ServoRun, AServoThatRestartsInTheRunIsNamedAndTheOthersRampDown) {
  RobotControlDrive options;
  options.ticks = 500;
  options.observer = [this](const host::GaitDriver::Tick& tick) {
    if (tick.number == 100) {
      servos.servo(3).restart();
    }
  };
  const DriveResult result = drive(shipped_gait("uniform"), options);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find("servo 3 (joint J3) has lost its torque: it has restarted"), std::string::npos);
  EXPECT_LE(result.gait_ticks, 110U);
  expect_ramped_down(3);
}

TEST_F(ServoRun, DamagedAnswersDoNotEndTheRun) {
  RobotControlDrive options;
  options.ticks = 500;
  options.observer = [this](const host::GaitDriver::Tick& tick) {
    EmulatedServo& servo = servos.servos[tick.number % 5];
    switch (tick.number % 40) {
      case 0:
        servo.corrupt = 1;
        break;
      case 10:
        servo.truncated = 1;
        break;
      case 20:
        servo.with_wrong_id = 1;
        break;
      case 30:
        servo.with_noise = 1;
        break;
      default:
        break;
    }
  };
  const DriveResult result = drive(shipped_gait("uniform"), options);
  EXPECT_FALSE(result.failure) << *result.failure;
  EXPECT_EQ(result.late_ticks, 0U);
  expect_ramped_down();
}

TEST_F(ServoRun, ARequestToStopRampsDown) {
  int ticks = 0;
  RobotControlDrive options;
  options.must_stop = [&] { return ++ticks > 200; };
  const DriveResult result = drive(shipped_gait("uniform"), options);
  EXPECT_FALSE(result.failure);
  EXPECT_GT(result.gait_ticks, 100U);
  expect_ramped_down();
}

TEST_F(ServoRun, SaysThatTheKernelsRunOnTheHost) {
  RobotControlDrive options;
  options.ticks = 1;
  static_cast<void>(drive(shipped_gait("uniform"), options));
  EXPECT_EQ(shown,
            (std::vector<std::string>{
                "the kernels of the gait run on this computer; the robot has no modules with a core of their own"}));
}

TEST(RobotControlDrive, AFileWithoutAPluginIsNamed) {
  sim::Scenario scenario = shipped_gait("uniform");
  scenario.robot_control.reset();
  scenario.path = "top.xml";
  EXPECT_EQ(message_of<InputError>([&] { static_cast<void>(drive_robot_control(scenario, {})); }),
            "top.xml: found a robot without <robot_control> in its file, expected one that names the plug-in "
            "(docs/robot-control.md), or a robot with modules and --bus");
}

TEST(RobotControlDrive, APluginThatIsMissingIsNamedWithItsLine) {
  sim::Scenario scenario = shipped_gait("uniform");
  scenario.robot_control->plugin = "./missing.so";
  const std::string error =
      message_of<host::RobotFileError>([&] { static_cast<void>(drive_robot_control(scenario, {})); });
  EXPECT_EQ(error.substr(0, error.find('(')), "robot.xml:3: /./missing.so: found no plug-in that can be loaded ");
}

TEST(RobotControlDrive, AParameterThatThePluginRejectsIsNamedWithItsLine) {
  sim::Scenario scenario = shipped_gait("uniform");
  scenario.robot_control->parameters[1].value = "12345";
  const std::string error =
      message_of<host::RobotFileError>([&] { static_cast<void>(drive_robot_control(scenario, {})); });
  EXPECT_EQ(error.substr(0, 33), "robot.xml:5: found baud '12345', ");
}

TEST(RobotControlDrive, TheExampleOfThePageDrivesAScenario) {
  sim::Scenario scenario = shipped_gait("uniform");
  scenario.robot_control->plugin = PROLEG_TEST_PLUGINS "/proleg-example.so";
  scenario.robot_control->parameters.clear();
  RobotControlDrive options;
  options.ticks = 100;
  ServoEmulator none(0);
  std::uint64_t now_us = 0;
  VirtualClock clock(none, now_us);
  const DriveResult result = drive_robot_control(scenario, options, robot_control_plugin(scenario), clock);
  EXPECT_FALSE(result.failure);
  EXPECT_EQ(result.gait_ticks, 100U);
  EXPECT_EQ(result.max_difference_deg, 0.0);  // its joints are where they should be
}

// With the plug-in as it is installed. The clock is that of the system: the test runs in virtual time.

TEST(RobotControlDrive, TheInstalledPluginDrivesServosBehindASerialPort) {
  ServoEmulator servos(5);
  test::PtyServos terminal(servos);
  const sim::Scenario scenario = shipped_gait("uniform", terminal.device());
  RobotControlDrive options;
  options.ticks = 20;
  const DriveResult result = drive_robot_control(scenario, options);
  terminal.stop();
  EXPECT_FALSE(result.failure) << *result.failure;
  EXPECT_EQ(result.gait_ticks, 20U);
  for (const EmulatedServo& servo : servos.servos) {
    EXPECT_FALSE(servo.has_power());
    EXPECT_EQ(servo.goals.back().position, 2048);
  }
}

TEST(RobotControlDrive, APortThatIsUnpluggedInTheRunEndsIt) {
  ServoEmulator servos(5);
  test::PtyServos terminal(servos);
  const sim::Scenario scenario = shipped_gait("uniform", terminal.device());
  RobotControlDrive options;
  options.ticks = 1000;
  options.observer = [&](const host::GaitDriver::Tick& tick) {
    if (tick.number == 5) {
      terminal.stop();
    }
  };
  const DriveResult result = drive_robot_control(scenario, options);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find(terminal.device()), std::string::npos) << *result.failure;
  EXPECT_NE(result.failure->find("the adapter was unplugged or lost its power"), std::string::npos) << *result.failure;
  // Nothing is sent any more: each servo stops by itself.
  servos.advance(UINT64_MAX / 2);
  for (const EmulatedServo& servo : servos.servos) {
    EXPECT_TRUE(servo.was_stopped_by_watchdog());
  }
}

TEST(RobotControlDrive, ASecondHostOnOnePortIsRefused) {
  ServoEmulator servos(5);
  test::PtyServos terminal(servos);
  const sim::Scenario scenario = shipped_gait("uniform", terminal.device());
  std::string second;
  RobotControlDrive options;
  options.ticks = 5;
  options.observer = [&](const host::GaitDriver::Tick& tick) {
    if (tick.number == 2) {
      second = message_of<host::RobotControlError>([&] { static_cast<void>(drive_robot_control(scenario, {})); });
    }
  };
  const DriveResult result = drive_robot_control(scenario, options);
  EXPECT_FALSE(result.failure) << *result.failure;
  EXPECT_NE(second.find("another program uses it: end that program"), std::string::npos) << second;
}

TEST(RobotControlDrive, APortThatDoesNotExistIsNamed) {
  const sim::Scenario scenario = shipped_gait("uniform", "/dev/no_such_port");
  EXPECT_EQ(message_of<host::RobotControlError>([&] { static_cast<void>(drive_robot_control(scenario, {})); }),
            "plug-in 'dynamixel': cannot open /dev/no_such_port: No such file or directory; plug the adapter in, or "
            "correct the parameter 'device' (ls /dev/serial/by-id)");
}

}  // namespace
}  // namespace proleg
