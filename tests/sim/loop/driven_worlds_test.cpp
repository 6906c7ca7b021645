#include "sim/loop/driven_worlds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

std::vector<std::int32_t> start_of(const Simulation& simulation) {
  std::vector<std::int32_t> start;
  for (unsigned joint = 0; joint < simulation.chain().joint_count(); ++joint) {
    start.push_back(simulation.chain().kernel(joint).setpoint(joint));
  }
  return start;
}

Scenario shipped_in(const std::string& file, PhysicsEngine engine) {
  Scenario scenario = shipped(file);
  scenario.environment.engine = engine;
  return scenario;
}

/// Compares worlds that get the set-points of simulations with these simulations, tick by tick.
void expect_motion_of_simulations(const std::vector<Scenario>& scenarios, unsigned ticks) {
  std::vector<std::unique_ptr<Simulation>> simulations;
  std::vector<const Scenario*> pointers;
  std::vector<std::int32_t> start;
  for (const Scenario& scenario : scenarios) {
    simulations.push_back(std::make_unique<Simulation>(scenario));
    pointers.push_back(&scenario);
    const std::vector<std::int32_t> own = start_of(*simulations.back());
    start.insert(start.end(), own.begin(), own.end());
  }
  DrivenWorlds worlds(pointers, start);
  for (unsigned tick = 0; tick < ticks; ++tick) {
    std::vector<std::int32_t> setpoints;
    for (std::size_t i = 0; i < simulations.size(); ++i) {
      const std::vector<std::uint8_t> contacts(worlds.contacts(i).begin(), worlds.contacts(i).end());
      simulations[i]->advance();
      ASSERT_TRUE(std::ranges::equal(contacts, simulations[i]->latched_contacts()))
          << "world " << i << ", tick " << tick;
      setpoints.insert(setpoints.end(), simulations[i]->setpoints().begin(), simulations[i]->setpoints().end());
    }
    worlds.advance(setpoints);
    for (std::size_t i = 0; i < simulations.size(); ++i) {
      const Plant& own = worlds.plant(i);
      const Plant& other = simulations[i]->plant();
      ASSERT_TRUE(std::ranges::equal(own.joint_angles(), other.joint_angles())) << "world " << i << ", tick " << tick;
      ASSERT_TRUE(std::ranges::equal(own.servo_currents(), other.servo_currents()));
      ASSERT_EQ(own.displacement(), other.displacement());
    }
  }
}

TEST(DrivenWorlds, MoveAsTheGaitThatGivesTheSetPoints) {
  std::vector<Scenario> scenarios(9, shipped_in("travelling_wave/uniform", PhysicsEngine::reduced));
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    apply_setting(scenarios[i], "amplitude=" + std::to_string(10 + 8 * i));
    apply_setting(scenarios[i], "phase=" + std::to_string(20 * i));
    scenarios[i].contact_noise = 0.02;
    scenarios[i].kernel.seed = i;
  }
  expect_motion_of_simulations(scenarios, 300);
}

TEST(DrivenWorlds, MoveInEveryEngine) {
  expect_motion_of_simulations({shipped_in("travelling_wave/uniform", PhysicsEngine::ode)}, 100);
  expect_motion_of_simulations({shipped_in("obstacle/reflex", PhysicsEngine::ode)}, 100);
}

TEST(DrivenWorlds, KeepSetPointsWithinTheLimits) {
  const Scenario scenario = shipped_in("travelling_wave/uniform", PhysicsEngine::reduced);
  const std::vector<const Scenario*> one{&scenario};
  const std::size_t joints = scenario.robot.joints.size();
  DrivenWorlds worlds(one, std::vector<std::int32_t>(joints));
  for (unsigned tick = 0; tick < 200; ++tick) {
    worlds.advance(std::vector<std::int32_t>(joints, tick % 100 < 50 ? INT32_MIN : INT32_MAX));
    for (std::size_t joint = 0; joint < joints; ++joint) {
      EXPECT_GE(worlds.setpoints(0)[joint], scenario.joint_limits[joint].lower);
      EXPECT_LE(worlds.setpoints(0)[joint], scenario.joint_limits[joint].upper);
    }
  }
}

TEST(DrivenWorlds, ThatFailStopAndTheOthersGoOn) {
  std::vector<Scenario> scenarios(3, shipped_in("travelling_wave/uniform", PhysicsEngine::reduced));
  scenarios[1].environment.gravity = Eigen::Vector3d(0.0, 0.0, 1e5);  // it flies off
  std::vector<const Scenario*> pointers{&scenarios[0], &scenarios[1], &scenarios[2]};
  DrivenWorlds worlds(pointers, std::vector<std::int32_t>(15));
  for (unsigned tick = 0; tick < 100; ++tick) {
    worlds.advance(std::vector<std::int32_t>(15));
  }
  EXPECT_FALSE(worlds.runs(1));
  EXPECT_NE(worlds.failure(1), "");
  EXPECT_TRUE(worlds.runs(0) && worlds.runs(2));
  EXPECT_EQ(worlds.plant(0).displacement(), worlds.plant(2).displacement());
}

TEST(DrivenWorlds, NeedRobotsWithEquallyManyJoints) {
  const Scenario five = shipped("travelling_wave/uniform");
  const Scenario twenty = shipped("long_chain/twenty");
  EXPECT_THROW(DrivenWorlds(std::vector<const Scenario*>{&five, &twenty}, std::vector<std::int32_t>(25)), InputError);
}

}  // namespace
}  // namespace proleg::sim
