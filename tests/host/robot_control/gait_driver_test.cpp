#include "host/robot_control/gait_driver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scripted_plugin.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using test::plugin_of;
using test::PluginScript;
using test::setup_of;

constexpr std::int32_t one_degree = (1 << 30) / 90;

/// Both joints jump to the same angle at each tick.
class Jumps final : public SetpointSource {
 public:
  explicit Jumps(std::int32_t start) : setpoints_(2, start) {}
  [[nodiscard]] std::span<const std::int32_t> setpoints() const override { return setpoints_; }
  void advance(std::span<const std::uint8_t> contacts) override {
    last_contacts.assign(contacts.begin(), contacts.end());
    if (fails_at == ++ticks) {
      throw std::logic_error("the kernel fails");
    }
    setpoints_.assign(2, next);
  }

  std::int32_t next = 0;
  std::uint32_t ticks = 0;
  std::uint32_t fails_at = 0;
  std::vector<std::uint8_t> last_contacts;

 private:
  std::vector<std::int32_t> setpoints_;
};

DriveLimits limits_of(std::uint32_t command_speed = 720) {
  return {{-60 * one_degree, -60 * one_degree}, {60 * one_degree, 60 * one_degree}, command_speed};
}

struct Rig {
  explicit Rig(std::int32_t start = 0, std::uint32_t ticks = 0)
      : control(plugin_of(script), setup_of(2), {}), source(start), driver(control, source, limits_of(), ticks, {}) {}

  void run() {
    for (int i = 0; i < 10'000 && driver.phase() != GaitDriver::Phase::finished; ++i) {
      static_cast<void>(driver.tick());
    }
    EXPECT_EQ(driver.phase(), GaitDriver::Phase::finished);
  }
  double largest_step() const {
    double largest = 0.0;
    for (std::size_t i = 1; i < script.goals.size(); ++i) {
      largest = std::max(largest, std::abs(script.goals[i][0] - script.goals[i - 1][0]));
    }
    return largest;
  }

  PluginScript script;
  RobotControl control;
  Jumps source;
  GaitDriver driver;
};

TEST(GaitDriver, RampsFromTheMeasuredAnglesAndTakesThePowerAtTheEnd) {
  Rig rig(20 * one_degree, 3);
  rig.script.values = {-30.0, 10.0};
  rig.source.next = 20 * one_degree;
  rig.driver.start();
  EXPECT_TRUE(rig.script.has_power);
  rig.run();
  const auto& goals = rig.script.goals;
  EXPECT_NEAR(goals.front()[0], -29.1, 1e-6);  // 90 degrees a second, ticks of 10 ms
  EXPECT_NEAR(goals.front()[1], 10.9, 1e-6);
  EXPECT_LE(rig.largest_step(), 0.9 + 1e-9);
  EXPECT_EQ(goals.back(), (std::vector<double>{0.0, 0.0}));
  EXPECT_FALSE(rig.script.has_power);
  EXPECT_EQ(rig.driver.gait_ticks(), 3U);
  EXPECT_FALSE(rig.driver.failure());
}

TEST(GaitDriver, CutsAnglesToTheLimitsAndTheGreatestSpeed) {
  Rig rig(0, 40);
  rig.source.next = 85 * one_degree;
  rig.driver.start();
  rig.run();
  double largest = 0.0;
  for (const auto& goal : rig.script.goals) {
    largest = std::max(largest, goal[0]);
  }
  EXPECT_NEAR(largest, 60.0, 1e-5);
  EXPECT_NEAR(rig.largest_step(), 7.2, 1e-6);  // 720 degrees a second
}

TEST(GaitDriver, TheLimitsOfThePluginCount) {
  PluginScript script;
  script.lower_deg = -10.0;
  script.upper_deg = 5.0;
  RobotControl control(plugin_of(script), setup_of(2), {});
  Jumps source(0);
  source.next = 30 * one_degree;
  GaitDriver driver(control, source, limits_of(), 20, {});
  driver.start();
  for (int i = 0; i < 15; ++i) {
    static_cast<void>(driver.tick());
  }
  EXPECT_NEAR(script.goals.back()[0], 5.0, 1e-6);
}

TEST(GaitDriver, DoesNotStartARobotOutsideOfItsLimits) {
  Rig rig;
  rig.script.values = {0.0, 64.0};
  EXPECT_EQ(
      message_of<RobotControlError>([&] { rig.driver.start(); }),
      "joint 'J2' is at 64 degrees, expected -60 to 60; move it there by hand, or correct its offset and direction "
      "in the robot's file");
  EXPECT_FALSE(rig.script.has_power);
  EXPECT_TRUE(rig.script.goals.empty());
}

TEST(GaitDriver, MovesNothingIfTheRobotDoesNotConnect) {
  Rig rig;
  rig.script.result = PROLEG_FAILED;
  rig.script.error = "servo 2 does not answer";
  EXPECT_EQ(message_of<RobotControlError>([&] { rig.driver.start(); }), "plug-in 'scripted': servo 2 does not answer");
  EXPECT_EQ(rig.script.calls, (std::vector<std::string>{"connect"}));
}

TEST(GaitDriver, ARequestToStopRampsDown) {
  Rig rig;
  rig.source.next = 30 * one_degree;
  rig.driver.start();
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(rig.driver.tick());
  }
  rig.driver.stop();
  const std::size_t before = rig.script.goals.size();
  rig.run();
  EXPECT_NEAR(rig.script.goals[before][0], 30.0 - 0.9, 1e-5);
  EXPECT_EQ(rig.script.goals.back()[0], 0.0);
  EXPECT_FALSE(rig.script.has_power);
}

TEST(GaitDriver, AFailureInTheGaitRampsDownWhatFollows) {
  Rig rig;
  rig.source.next = 30 * one_degree;
  rig.driver.start();
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(rig.driver.tick());
  }
  rig.script.result = PROLEG_FAILED;
  rig.script.error = "servo 2 has not answered";
  rig.run();
  EXPECT_EQ(rig.driver.failure(), "plug-in 'scripted': servo 2 has not answered");
  EXPECT_LE(rig.largest_step(), 7.2 + 1e-6);
  EXPECT_EQ(rig.script.goals.back()[0], 0.0);
  EXPECT_FALSE(rig.script.has_power);
  EXPECT_EQ(rig.script.calls.back(), "disconnect");
}

TEST(GaitDriver, AFailureOfAKernelRampsDown) {
  Rig rig;
  rig.source.fails_at = 3;
  rig.driver.start();
  rig.run();
  EXPECT_EQ(rig.driver.failure(), "the kernel fails");
  EXPECT_FALSE(rig.script.has_power);
}

TEST(GaitDriver, ValuesThatNoRobotHasEndTheRun) {
  Rig rig;
  rig.driver.start();
  static_cast<void>(rig.driver.tick());
  rig.script.values = {std::nan(""), 0.0};
  rig.run();
  EXPECT_EQ(rig.driver.failure(),
            "plug-in 'scripted': returned nan as position of joint 'J1', expected -360 to 360 degrees");
}

TEST(GaitDriver, KernelsGetTheDebouncedContactsOfTheirLinks) {
  PluginScript script;
  script.sensor_modules = 3;
  script.sensors_per_module = 2;
  script.values = {0.0, 0.0};
  RobotControl control(plugin_of(script), setup_of(2), {});
  Jumps source(0);
  GaitDriver driver(control, source, limits_of(), 0, {});
  script.on_call = [&](const std::string& call) {
    // What the next request gets: the head's front sensor, the rear one behind joint 0, both behind joint 1; or angles.
    if (call == "position") {
      script.values = {0, 1, 1, 0, 1, 1};
    } else if (call == "contact") {
      script.values = {0, 0};
    }
  };
  driver.start();
  for (int i = 0; i < 4; ++i) {
    static_cast<void>(driver.tick());
  }
  EXPECT_FALSE(driver.failure()) << *driver.failure();
  EXPECT_EQ(source.last_contacts, (std::vector<std::uint8_t>{0b1001, 0b0011}));
}

/// Time passes only in sleep, and in a tick what the test wants.
class ScriptedClock final : public Clock {
 public:
  [[nodiscard]] std::uint64_t now_us() override { return now; }
  void sleep_until(std::uint64_t time_us) override {
    now = std::max(now, time_us);
    if (++sleeps == slow_at) {
      now += 55'000;
    }
    times.push_back(now);
  }

  std::uint64_t now = 1000;
  unsigned sleeps = 0;
  unsigned slow_at = 0;
  std::vector<std::uint64_t> times;
};

TEST(DriveLoop, SendsATickInEachPeriodUntilTheEnd) {
  Rig rig(0, 10);
  ScriptedClock clock;
  const DriveResult result = drive(rig.driver, clock, {});
  EXPECT_EQ(result.gait_ticks, 10U);
  EXPECT_EQ(result.late_ticks, 0U);
  EXPECT_FALSE(result.failure);
  for (std::size_t i = 1; i < clock.times.size(); ++i) {
    EXPECT_EQ(clock.times[i] - clock.times[i - 1], 10'000U);
  }
}

TEST(DriveLoop, ALateTickMovesTheFollowingOnes) {
  Rig rig(0, 10);
  ScriptedClock clock;
  clock.slow_at = 5;
  const DriveResult result = drive(rig.driver, clock, {});
  EXPECT_EQ(result.late_ticks, 1U);
  EXPECT_EQ(result.max_delay_us, 55'000U);
  EXPECT_EQ(clock.times[5] - clock.times[4], 10'000U);  // no burst
}

TEST(DriveLoop, StopsWhenItMust) {
  Rig rig;
  ScriptedClock clock;
  const DriveResult result = drive(rig.driver, clock, [&] { return clock.sleeps > 50; });
  EXPECT_EQ(result.gait_ticks, 49U);
  EXPECT_FALSE(rig.script.has_power);
}

}  // namespace
}  // namespace proleg::host
