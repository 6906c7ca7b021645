#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

Scenario shipped(const std::string& name) {
  DiskFiles files;
  return read_scenario(PROLEG_SOURCE_DIR "/sim/scenarios/travelling_wave/" + name + ".simulation.xml", files);
}

class Shipped : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(TravellingWave, Shipped, testing::Values("uniform", "tail_fixed", "coupled"),
                         [](const auto& name) { return name.param; });

TEST_P(Shipped, HasTheFittedRobot) {
  const RobotModel robot = shipped(GetParam()).robot;
  ASSERT_EQ(robot.links.size(), 6U);
  EXPECT_EQ(robot.servo.gain, 50.0);
  EXPECT_EQ(robot.servo.period_us, 1000U);
  EXPECT_EQ(robot.links.front().name, "Head");
  EXPECT_EQ(robot.links.back().name, "Tail");
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const bool end = i == 0 || i == 5;
    const double half_length = end ? 0.018 : 0.036;
    const Link& link = robot.links[i];
    // Where the middle of the link is on a chain from y = -36 mm to y = 324 mm.
    const double middle = i == 0 ? 0.306 : (i == 5 ? -0.018 : 0.036 + 0.072 * static_cast<double>(4 - i));
    EXPECT_NEAR((link.pose * link.mass.center).y(), middle, 1e-12);
    EXPECT_EQ(link.mass.mass, end ? 0.05 : 0.1);
    const double mass_over_three = link.mass.mass / 3.0;
    EXPECT_NEAR(link.mass.inertia(0, 0), mass_over_three * (half_length * half_length + 0.026 * 0.026), 1e-12);
    EXPECT_NEAR(link.mass.inertia(1, 1), mass_over_three * (0.026 * 0.026 + 0.026 * 0.026), 1e-12);
    EXPECT_NEAR(link.mass.inertia(2, 2), link.mass.inertia(0, 0), 1e-12);
    ASSERT_EQ(link.geometries.size(), 1U);
    EXPECT_EQ(link.geometries[0].extents, Eigen::Vector3d(0.026, end ? 0.004 : 0.018, 0.026));
    EXPECT_NEAR((link.pose * link.geometries[0].pose.position).y(), middle, 1e-12);
    EXPECT_FALSE(link.geometries[0].friction.has_value());
  }
}

TEST_P(Shipped, HasPitchJointsEvery72Millimetres) {
  const RobotModel robot = shipped(GetParam()).robot;
  ASSERT_EQ(robot.joints.size(), 5U);
  for (std::size_t j = 0; j < 5; ++j) {
    const Joint& joint = robot.joints[j];
    EXPECT_EQ(joint.name, "J" + std::to_string(5 - j));
    EXPECT_TRUE(joint.axis.isApprox(Eigen::Vector3d::UnitX()));
    EXPECT_TRUE(joint.anchor.isApprox(Eigen::Vector3d(0, 0.072 * static_cast<double>(4 - j), 0)));
    EXPECT_EQ(joint.max_torque, 0.4);
    EXPECT_EQ(joint.max_speed, 4.5);
    EXPECT_DOUBLE_EQ(joint.upper_limit, std::numbers::pi / 2);
  }
}

TEST_P(Shipped, StartsOnTheFloorAndSaysNothingButTheJointMap) {
  const Scenario scenario = shipped(GetParam());
  EXPECT_EQ(scenario.environment.robot_pose.position, Eigen::Vector3d(0, 0, 0.026));
  ASSERT_EQ(scenario.environment.objects.size(), 1U);
  EXPECT_EQ(scenario.environment.objects[0].geometries[0].friction, 0.1);
  ASSERT_EQ(scenario.remarks.size(), 1U) << scenario.remarks[1];
  EXPECT_TRUE(scenario.remarks[0].starts_with("joint map: kernel 0 = J5 (Head - 4Seg), "));
}

TEST_P(Shipped, RunsThirtySecondsInStepsOfAMillisecondAndTicksOfTen) {
  const Scenario scenario = shipped(GetParam());
  EXPECT_EQ(scenario.duration_s, 30.0);
  EXPECT_EQ(scenario.step_s, 0.001);
  EXPECT_EQ(scenario.kernel.tick_period_us, 10'000U);
  EXPECT_EQ(scenario.kernel.seed, 1U);
  EXPECT_EQ(scenario.solver, Solver::automatic);
}

/// The value that a joint starts with: the setting, or the default.
std::int32_t start_value(const Scenario& scenario, std::string_view parameter, unsigned joint) {
  const Declaration& declaration = scenario.kernel.slots[0].algorithm->declaration();
  const int index = find_parameter(declaration, parameter);
  for (const Setting& setting : scenario.settings) {
    if (setting.slot == 0 && setting.joint == joint && setting.index == index) {
      return setting.value;
    }
  }
  return declaration.parameters[static_cast<std::size_t>(index)].default_value;
}

TEST_P(Shipped, HasFortyDegreesAtOneHertzAndFiftyFiveDegreesOfPhase) {
  const Scenario scenario = shipped(GetParam());
  for (unsigned joint = 0; joint < 5; ++joint) {
    const bool still = GetParam() == "tail_fixed" && joint == 4;
    EXPECT_EQ(start_value(scenario, "amplitude", joint), still ? 0 : parse_decimal("40", Unit::degree).raw);
    EXPECT_EQ(start_value(scenario, "frequency", joint), parse_decimal("1", Unit::hertz).raw);
    EXPECT_EQ(start_value(scenario, "phase_difference", joint), parse_decimal("55", Unit::phase_degree).raw);
  }
}

TEST_P(Shipped, DrivesAllJointsWithItsAlgorithm) {
  const Scenario scenario = shipped(GetParam());
  EXPECT_EQ(
      scenario.kernel.slots[0].algorithm,
      find_algorithm(GetParam() == "coupled" ? "PatternGenerator_coupled_oscillator" : "PatternGenerator_sinusoidal"));
  EXPECT_EQ(scenario.kernel.slots[0].group, JointMask::first(5));
  EXPECT_EQ(scenario.kernel.slots[1].algorithm, nullptr);
}

/// Runs the kernel alone for two seconds and finds, for the second one, the tick at which each joint has its largest
/// set-point.
std::vector<int> ticks_of_the_crests(const Scenario& scenario) {
  std::vector<JointMemory> memory(scenario.kernel.joint_count);
  Kernel kernel(memory);
  EXPECT_EQ(kernel.configure(scenario.kernel, 0), Status::ok);
  for (const Setting& setting : scenario.settings) {
    EXPECT_EQ(kernel.set_parameter(setting.slot, setting.joint, setting.index, setting.value), Status::ok);
  }
  kernel.reset();
  std::vector<int> ticks(memory.size());
  std::vector<std::int32_t> crests(memory.size(), std::numeric_limits<std::int32_t>::min());
  for (int tick = 0; tick < 200; ++tick) {
    for (unsigned joint = 0; tick >= 100 && joint < memory.size(); ++joint) {
      if (kernel.setpoint(joint) > crests[joint]) {
        crests[joint] = kernel.setpoint(joint);
        ticks[joint] = tick - 100;
      }
    }
    kernel.advance();
  }
  return ticks;
}

TEST(Uniform, WaveRunsFromTheTailToTheHeadSoThatTheHeadLeadsTheCrawl) {
  // 55 degrees at 1 Hz are 15.3 ticks of 10 ms.
  const std::vector<int> ticks = ticks_of_the_crests(shipped("uniform"));
  for (std::size_t j = 0; j + 1 < ticks.size(); ++j) {
    const int delay = (ticks[j] - ticks[j + 1] + 100) % 100;
    EXPECT_NEAR(delay, 15.3, 1.3) << "kernel joint " << j;
  }
}

}  // namespace
}  // namespace proleg::sim
