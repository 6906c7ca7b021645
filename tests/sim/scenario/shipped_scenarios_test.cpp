#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

Scenario shipped(const std::string& name, const std::string& folder = "travelling_wave") {
  DiskFiles files;
  return read_scenario(source_path("/sim/scenarios/") + folder + "/" + name + ".simulation.xml", files);
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

TEST_P(Shipped, StartsOnTheFloorWithNoRemarkButTheJointMap) {
  const Scenario scenario = shipped(GetParam());
  EXPECT_EQ(scenario.environment.robot_pose.position, Eigen::Vector3d(0, 0, 0.026));
  ASSERT_EQ(scenario.environment.objects.size(), 1U);
  EXPECT_EQ(scenario.environment.objects[0].geometries[0].friction, 0.1);
  ASSERT_EQ(scenario.remarks.size(), 1U) << scenario.remarks[1];
  EXPECT_TRUE(
      scenario.remarks[0].starts_with("joints from the head, where recordings count from 0: J5 (Head - 4Seg), "));
}

TEST_P(Shipped, RunsThirtySecondsInStepsOfAMillisecondAndTicksOfTen) {
  const Scenario scenario = shipped(GetParam());
  EXPECT_EQ(scenario.duration_s, 30.0);
  EXPECT_EQ(scenario.step_s, 0.001);
  EXPECT_EQ(scenario.kernel.tick_period_us, 10'000U);
  EXPECT_EQ(scenario.kernel.seed, 1U);
  EXPECT_EQ(scenario.solver, Solver::automatic);
}

std::int32_t start_value(const Scenario& scenario, std::string_view parameter, unsigned joint, unsigned slot = 0) {
  const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
  const int index = find_parameter(declaration, parameter);
  return sim::start_value(scenario, slot, joint, static_cast<unsigned>(index));
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
    EXPECT_EQ(kernel.set_parameter(setting), Status::ok);
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

class Obstacle : public testing::TestWithParam<std::string> {
 protected:
  const Scenario scenario_ = shipped(GetParam(), "obstacle");
};

INSTANTIATE_TEST_SUITE_P(Shipped, Obstacle, testing::Values("plain", "reflex"),
                         [](const auto& name) { return name.param; });

TEST_P(Obstacle, HasTheRobotAndTheWaveOfTheUniformTravellingWave) {
  const Scenario wave = shipped("uniform");
  ASSERT_EQ(scenario_.robot.links.size(), wave.robot.links.size());
  for (std::size_t i = 0; i < wave.robot.links.size(); ++i) {
    EXPECT_EQ(scenario_.robot.links[i].name, wave.robot.links[i].name);
    EXPECT_EQ(scenario_.robot.links[i].mass.mass, wave.robot.links[i].mass.mass);
    EXPECT_EQ(scenario_.robot.links[i].geometries[0].extents, wave.robot.links[i].geometries[0].extents);
  }
  EXPECT_EQ(scenario_.robot.servo.gain, wave.robot.servo.gain);
  EXPECT_EQ(scenario_.robot.servo.period_us, wave.robot.servo.period_us);
  EXPECT_EQ(scenario_.kernel.slots[0].algorithm, wave.kernel.slots[0].algorithm);
  EXPECT_EQ(scenario_.kernel.slots[0].group, JointMask::first(5));
  for (const char* parameter : {"amplitude", "frequency", "phase_difference"}) {
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_EQ(start_value(scenario_, parameter, joint), start_value(wave, parameter, joint)) << parameter;
    }
  }
}

TEST_P(Obstacle, HasTwoStepsUpAndTwoDownAcrossTheWholeWay) {
  struct Step {
    double from;  // m, along the way
    double to;
    double height;
  };
  const std::vector<StaticObject>& objects = scenario_.environment.objects;
  ASSERT_EQ(objects.size(), 3U) << "each body is an object";
  const std::vector<Step> steps{{-1000, 1000, 0}, {0.5, 1.7, 0.03}, {0.9, 1.3, 0.06}};
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Geometry& geometry = objects[i].geometries.at(0);
    const Eigen::Vector3d middle = (objects[i].pose * geometry.pose).position;
    EXPECT_NEAR(middle.y() - geometry.extents.y(), steps[i].from, 1e-9);
    EXPECT_NEAR(middle.y() + geometry.extents.y(), steps[i].to, 1e-9);
    EXPECT_NEAR(middle.z() + geometry.extents.z(), steps[i].height, 1e-9);
    EXPECT_GE(geometry.extents.x(), 1.0);
    EXPECT_EQ(middle.x(), 0.0);
    EXPECT_EQ(geometry.friction, 0.5);
  }
  EXPECT_EQ(scenario_.environment.robot_pose.position, Eigen::Vector3d(0, 0, 0.026));
}

TEST_P(Obstacle, RunsThirtySecondsOnTheDirectStepperWithNoRemarkButTheJointMap) {
  EXPECT_EQ(scenario_.duration_s, 30.0);
  EXPECT_EQ(scenario_.step_s, 0.001);
  EXPECT_EQ(scenario_.kernel.tick_period_us, 10'000U);
  EXPECT_EQ(scenario_.solver, Solver::direct);
  ASSERT_EQ(scenario_.remarks.size(), 1U) << scenario_.remarks[1];
}

TEST_P(Obstacle, HasTheReflexOnAllJointsWithItsDefaultsOrNotAtAll) {
  const Slot& slot = scenario_.kernel.slots[1];
  if (GetParam() == "plain") {
    EXPECT_EQ(slot.algorithm, nullptr);
    return;
  }
  ASSERT_EQ(slot.algorithm, find_algorithm("SensingModule_uneven_ground_reflex"));
  EXPECT_EQ(slot.group, JointMask::first(5));
  for (const Parameter& parameter : slot.algorithm->declaration().parameters) {
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_EQ(start_value(scenario_, parameter.name, joint, 1), parameter.default_value)
          << parameter.name << ": the file says that its values are the defaults";
    }
  }
}

}  // namespace
}  // namespace proleg::sim
