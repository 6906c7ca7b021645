#include "tools/proleg/document/telemetry_row.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::tools {
namespace {

/// The values of a signal in a row, in its unit.
std::vector<double> values(const std::vector<host::Signal>& signals, const std::vector<std::int32_t>& row,
                           const std::string& name) {
  std::size_t begin = 0;
  for (const host::Signal& signal : signals) {
    if (signal.name == name) {
      std::vector<double> found;
      for (std::size_t i = 0; i < signal.count; ++i) {
        found.push_back(row.at(begin + i) * signal.scale);
      }
      return found;
    }
    begin += signal.count;
  }
  throw std::runtime_error("no signal " + name);
}

TEST(TelemetryRow, HasTheValuesOfTheRecordingInTheUnitsOfTheSignals) {
  for (const char* name : {"travelling_wave/uniform", "travelling_wave/coupled"}) {
    SCOPED_TRACE(name);
    const sim::Scenario scenario = sim::shipped(name);
    sim::Simulation simulation(scenario);
    for (int tick = 0; tick < 77; ++tick) {
      simulation.advance();
    }
    const std::vector<host::Signal> signals = signals_of(scenario);
    std::vector<std::int32_t> row;
    fill_row(simulation.sample(), scenario, row);
    std::size_t size = 0;
    for (const host::Signal& signal : signals) {
      size += signal.count;
    }
    ASSERT_EQ(row.size(), size);
    const sim::Plant& plant = simulation.plant();
    for (unsigned joint = 0; joint < 5; ++joint) {
      constexpr double degrees = 180.0 / std::numbers::pi;
      EXPECT_NEAR(values(signals, row, "angle")[joint], plant.joint_angles()[joint] * degrees, 1e-7);
      EXPECT_NEAR(values(signals, row, "setpoint")[joint], simulation.setpoints()[joint] * 45.0 / (1 << 29), 1e-12);
      EXPECT_NEAR(values(signals, row, "current")[joint], plant.servo_currents()[joint], 0.5);
      EXPECT_NEAR(values(signals, row, "torque")[joint], plant.motor_torques()[joint] * 1e3, 0.5);
      EXPECT_NEAR(values(signals, row, "pulse")[joint], plant.servo_commands()[joint] / 12.0, 1e-9);
    }
    for (unsigned link = 0; link < 6; ++link) {
      EXPECT_EQ(values(signals, row, "contact")[link], simulation.latched_contacts()[link]);
      EXPECT_NEAR(values(signals, row, "force")[link], plant.contact_forces()[link] * 1e3, 0.5);
    }
    const std::vector<double> head = values(signals, row, "head");
    const sim::Pose& pose = plant.link_poses()[0];
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(head[static_cast<std::size_t>(axis)] * 1e-6, pose.position[axis], 5e-7);
    }
    EXPECT_NEAR(head[3] / (1 << 30), pose.orientation.w(), 1e-9);
    EXPECT_NEAR(head[6] / (1 << 30), pose.orientation.z(), 1e-9);
    const Declaration& declaration = scenario.kernel.slots[0].algorithm->declaration();
    for (unsigned value = 0; value < declaration.internal_values.size(); ++value) {
      const std::string signal = "1/" + std::string(declaration.internal_values[value].name);
      const std::vector<double> shown = values(signals, row, signal);
      const auto found = std::ranges::find(signals, signal, &host::Signal::name);
      std::vector<unsigned> group;
      for (const unsigned joint : scenario.kernel.slots[0].group) {
        group.push_back(joint);
      }
      ASSERT_EQ(found->count, group.size());
      for (std::size_t i = 0; i < group.size(); ++i) {
        const std::int32_t raw = simulation.chain().kernel(group[i]).internal_value(0, group[i], value);
        EXPECT_DOUBLE_EQ(shown[i], raw * found->scale);
      }
    }
  }
}

TEST(TelemetryRow, HasTheQuantitiesOfAttachedSensors) {
  const sim::Scenario scenario = sim::shipped("retreat/wall");
  sim::Simulation simulation(scenario);
  for (int tick = 0; tick < 42; ++tick) {
    simulation.advance();
  }
  const std::vector<host::Signal> signals = signals_of(scenario);
  std::vector<std::int32_t> row;
  fill_row(simulation.sample(), scenario, row);
  const std::span<const double> measured = simulation.plant().sensors().values();
  const auto one = [&](const std::string& name) { return values(signals, row, name).at(0); };
  EXPECT_EQ(one("sensor/bumper/pressed"), measured[0]);
  EXPECT_NEAR(one("sensor/eye/nearest"), *std::ranges::min_element(measured.subspan(4, 13)), 5e-4);
  EXPECT_NEAR(one("sensor/level/pitch"), measured[17], 5e-4);
  EXPECT_NEAR(one("sensor/level/roll"), measured[18], 5e-4);
  EXPECT_NEAR(one("sensor/shock/acceleration"), std::hypot(measured[19], measured[20], measured[21]), 5e-4);
  EXPECT_NEAR(one("sensor/effort/current"), measured[22], 5e-4);

  sim::TickSample of_a_real_robot = simulation.sample();
  of_a_real_robot.sensor_values = {};
  const std::size_t size = row.size();
  fill_row(of_a_real_robot, scenario, row);
  ASSERT_EQ(row.size(), size);
  EXPECT_EQ(row.back(), host::no_value);
}

/// The page computes the poses of all links from the head's and the joint angles; this is its formula.
TEST(TelemetryRow, PosesOfAllLinksFollowFromTheHeadAndTheAngles) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::Simulation simulation(scenario);
  for (int tick = 0; tick < 150; ++tick) {
    simulation.advance();
  }
  const auto affine = [](const sim::Pose& pose) { return Eigen::Translation3d(pose.position) * pose.orientation; };
  Eigen::Isometry3d carried =
      affine(simulation.plant().link_poses()[0]) * Eigen::Isometry3d(affine(scenario.robot.links[0].pose)).inverse();
  for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
    const sim::Joint& its = scenario.robot.joints[joint];
    carried = carried * Eigen::Translation3d(its.anchor) *
              Eigen::AngleAxisd(-simulation.plant().joint_angles()[joint], its.axis) *
              Eigen::Translation3d(-its.anchor);
    const Eigen::Isometry3d link = carried * affine(scenario.robot.links[joint + 1].pose);
    const sim::Pose& expected = simulation.plant().link_poses()[joint + 1];
    EXPECT_LT((link.translation() - expected.position).norm(), 0.002) << "link " << joint + 1;
    EXPECT_LT(Eigen::Quaterniond(link.rotation()).angularDistance(expected.orientation), 0.02) << "link " << joint + 1;
  }
}

TEST(TelemetryRow, HasThePosesOfObjectsThatMove) {
  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  EXPECT_EQ(std::ranges::count(signals_of(scenario), "object", &host::Signal::name), 0) << "there are none";
  sim::Geometry ball;
  ball.shape = sim::Shape::sphere;
  ball.extents.x() = 0.05;
  sim::MassProperties mass;
  mass.mass = 0.1;
  mass.inertia *= 1e-4;
  scenario.environment.moving_objects.push_back({"ball", {{1, 2, 0.5}, {1, 0, 0, 0}}, mass, {ball}, {}});
  sim::Simulation simulation(scenario);
  for (int tick = 0; tick < 20; ++tick) {
    simulation.advance();
  }
  std::vector<std::int32_t> row;
  fill_row(simulation.sample(), scenario, row);
  const std::vector<double> object = values(signals_of(scenario), row, "object");
  ASSERT_EQ(object.size(), 7U);
  EXPECT_NEAR(object[0] * 1e-6, 1.0, 1e-6);
  EXPECT_NEAR(object[1] * 1e-6, 2.0, 1e-6);
  EXPECT_NEAR(object[2] * 1e-6, 0.5 - 9.81 * 0.2 * 0.2 / 2.0, 2e-3) << "it falls";
  sim::TickSample of_a_real_robot = simulation.sample();
  of_a_real_robot.object_poses = {};
  fill_row(of_a_real_robot, scenario, row);
  EXPECT_EQ(values(signals_of(scenario), row, "object")[0], host::no_value);
}

}  // namespace
}  // namespace proleg::tools
