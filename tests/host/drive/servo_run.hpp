#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/dynamixel/plugin.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/host/dynamixel/emulated_line.hpp"
#include "tests/support/files.hpp"
#include "tools/proleg/robot/robot_control_drive.hpp"

namespace proleg {

/// A shipped scenario, with the plug-in for bus servos.
inline sim::Scenario shipped_gait(const std::string& name, const std::string& device = "/dev/emulated") {
  sim::DiskFiles files;
  sim::Scenario scenario =
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/" + name + ".simulation.xml"), files);
  scenario.robot_control =
      sim::RobotControlEntry{"dynamixel", "robot.xml", "/", 3, {{"device", device, {}, 4}, {"baud", "1000000", {}, 5}}};
  return scenario;
}

/// The time of servos and drive. Used by two threads in turn: a call of the plug-in ends before the drive continues.
class VirtualClock final : public host::Clock {
 public:
  VirtualClock(test::ServoEmulator& servos, std::uint64_t& now_us) : servos_(servos), now_us_(now_us) {}
  [[nodiscard]] std::uint64_t now_us() override { return now_us_; }
  void sleep_until(std::uint64_t time_us) override {
    now_us_ = std::max(now_us_, time_us);
    servos_.advance(now_us_);
  }

 private:
  test::ServoEmulator& servos_;
  std::uint64_t& now_us_;
};

/// A scenario on five emulated servos on virtual time.
class ServoRun : public testing::Test {
 protected:
  ServoRun() {
    host::use_lines_of([this](const std::string& device, unsigned rate) {
      EXPECT_EQ(device, "/dev/emulated");
      return std::make_unique<test::EmulatedLine>(servos, now_us, rate);
    });
  }
  ~ServoRun() override {
    host::use_lines_of(
        [](const std::string&, unsigned) -> std::unique_ptr<host::Line> { throw host::LineError("no servos"); });
  }

  host::DriveResult drive(const sim::Scenario& scenario, RobotControlDrive options) {
    options.show = [this](const std::string& line) { shown.push_back(line); };
    const host::Plugin plugin = host::check_plugin(&host::dynamixel_plugin(), "dynamixel");
    VirtualClock clock(servos, now_us);
    return drive_robot_control(scenario, options, plugin, clock);
  }
  [[nodiscard]] bool any_has_power() const {
    return std::ranges::any_of(servos.servos, [](const test::EmulatedServo& servo) { return servo.has_power(); });
  }
  /// The last goal of all servos is 0 degrees, apart from that of a missing one.
  void expect_ramped_down(std::uint8_t missing = 0) {
    for (const test::EmulatedServo& servo : servos.servos) {
      if (servo.id != missing) {
        EXPECT_EQ(servo.goals.back().position, 2048) << unsigned{servo.id};
        EXPECT_FALSE(servo.has_power()) << unsigned{servo.id};
      }
    }
  }

  test::ServoEmulator servos{5};
  std::uint64_t now_us = 1'000'000;
  std::vector<std::string> shown;
};

}  // namespace proleg
