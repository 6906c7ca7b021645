// A gait that is real has nothing against it; a distance that an error of the physics gives is caught.

#include "sim/optimize/confirm/gait_confirmation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "sim/mujoco/mujoco_world.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

constexpr ConfirmationOptions few{6, 1};

sim::Scenario travelling_wave(double seconds) {
  sim::DiskFiles files;
  sim::Scenario scenario =
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
  scenario.duration_s = seconds;
  return scenario;
}

GaitConfirmation confirm(const sim::Scenario& scenario) { return confirm_gait(scenario, few, {}); }

const ConfirmationFinding& finding(const GaitConfirmation& confirmation, const std::string& name) {
  return *std::ranges::find(confirmation.findings, name, &ConfirmationFinding::name);
}

TEST(GaitConfirmation, HasNothingAgainstTheTravellingWave) {
  const GaitConfirmation confirmation = confirm(travelling_wave(6.0));
  EXPECT_TRUE(confirmation.is_real()) << confirmation_text(confirmation);
  ASSERT_EQ(confirmation.runs.size(), 5U);
  EXPECT_EQ(confirmation.runs[1].step_s, 0.0005);
  EXPECT_NE(confirmation.runs[2].engine, confirmation.runs[0].engine);
  EXPECT_EQ(confirmation.perturbed.size(), few.worlds);
  EXPECT_LT(confirmation.perturbed.front(), confirmation.perturbed.back()) << "the worlds differ";
}

TEST(GaitConfirmation, TheEnergyOfARunIsAccountedFor) {
  for (const ConfirmedRun& run : confirm(travelling_wave(4.0)).runs) {
    if (run.is_refused) {
      EXPECT_FALSE(sim::mujoco::is_built_in()) << run.name;
      continue;
    }
    EXPECT_NEAR(run.energy.unexplained, run.energy.stored - run.energy.motors + run.energy.friction, 1e-9) << run.name;
    EXPECT_GT(run.energy.motors, run.energy.friction) << run.name;
    EXPECT_GT(run.energy.friction, 0.0) << run.name;
    EXPECT_LT(run.energy.unexplained, 0.0) << run.name << ": links that strike the ground lose energy";
  }
}

/// The tail starts inside a wall by less than what a start may be inside the ground: contacts throw the robot away from
/// it.
sim::Scenario thrown() {
  sim::Scenario scenario = travelling_wave(3.0);
  sim::apply_setting(scenario, "amplitude=3");
  sim::StaticObject wall;
  wall.name = "wall";
  wall.pose.position = {0.0, -0.022 - 0.5 + 0.0029, 0.25};
  sim::Geometry box;
  box.extents = {1.0, 0.5, 0.25};
  box.friction = 0.1;
  wall.geometries.push_back(box);
  scenario.environment.objects.push_back(wall);
  return scenario;
}

TEST(GaitConfirmation, CatchesAStartThatJumps) {
  const GaitConfirmation confirmation = confirm(thrown());
  EXPECT_FALSE(confirmation.is_real()) << confirmation_text(confirmation);
  EXPECT_FALSE(finding(confirmation, "start").is_good) << confirmation_text(confirmation);
}

TEST(GaitConfirmation, CatchesAGaitThatLivesOnACoarseStep) {
  sim::Scenario scenario = travelling_wave(6.0);
  scenario.step_s = 0.01;
  sim::apply_setting(scenario, "amplitude=60");
  sim::apply_setting(scenario, "frequency=2.2");
  const GaitConfirmation confirmation = confirm(scenario);
  EXPECT_EQ(confirmation.runs[1].step_s, 0.001) << "half of 10 ms is still coarse";
  EXPECT_FALSE(confirmation.is_real()) << confirmation_text(confirmation);
  EXPECT_FALSE(finding(confirmation, "energy").is_good) << confirmation_text(confirmation);
}

TEST(GaitConfirmation, SaysWhatTheOtherEngineDoesNotHave) {
  sim::Scenario scenario = travelling_wave(2.0);
  scenario.robot.links[2].geometries[0].shape = sim::Shape::sphere;
  const GaitConfirmation confirmation = confirm(scenario);
  const ConfirmationFinding& other = finding(confirmation, "the other engine");
  EXPECT_TRUE(other.is_good) << "what cannot be compared is no doubt";
  EXPECT_NE(other.text.find("not compared"), std::string::npos) << other.text;
  EXPECT_NE(other.text.find("sphere"), std::string::npos) << other.text;
  EXPECT_EQ(confirmation.perturbed_engine, sim::PhysicsEngine::ode);
}

TEST(GaitConfirmation, AsksMujocoTooWhereItIsBuiltIn) {
  if (!sim::mujoco::is_built_in()) {
    GTEST_SKIP() << "built without MuJoCo";
  }
  const sim::Scenario scenario = travelling_wave(6.0);
  const GaitConfirmation confirmation = confirm(scenario);
  EXPECT_TRUE(finding(confirmation, "MuJoCo").is_good) << confirmation_text(confirmation);
  const ConfirmedRun& mujoco = confirmation.runs.back();
  EXPECT_EQ(mujoco.engine, sim::PhysicsEngine::mujoco);
  EXPECT_NEAR(mujoco.distance, confirmation.runs.front().distance, 0.05);
  EXPECT_NEAR(mujoco.energy.motors, confirmation.runs.front().energy.motors, 0.1);
  EXPECT_NEAR(mujoco.energy.friction, confirmation.runs.front().energy.friction, 0.05);
}

TEST(GaitConfirmation, ADistanceThatMujocoDoesNotGiveIsADoubt) {
  GaitConfirmation confirmation;
  for (const auto& [name, engine, distance] :
       {std::tuple("as it is", sim::PhysicsEngine::ode, 1.0), std::tuple("MuJoCo", sim::PhysicsEngine::mujoco, 0.7)}) {
    ConfirmedRun run{name, engine, 0.001};
    run.distance = distance;
    run.first_share = 0.1;
    run.first_second = 0.1 * distance;
    run.energy.motors = 1.0;
    confirmation.runs.push_back(run);
  }
  confirmation.perturbed = {1.0};
  confirmation.findings = findings_of(confirmation);
  EXPECT_FALSE(finding(confirmation, "MuJoCo").is_good);
  EXPECT_FALSE(confirmation.is_real()) << confirmation_text(confirmation);
  confirmation.runs.back().distance = 0.9;
  EXPECT_TRUE(std::ranges::all_of(findings_of(confirmation), &ConfirmationFinding::is_good));
}

TEST(GaitConfirmation, IsTheSameForTheSameSeed) {
  const sim::Scenario scenario = travelling_wave(1.0);
  EXPECT_EQ(confirm(scenario).perturbed, confirm(scenario).perturbed);
  EXPECT_NE(confirm(scenario).perturbed, confirm_gait(scenario, {few.worlds, 2}, {}).perturbed);
}

TEST(GaitConfirmation, EndsWhenItIsAsked) {
  double last = 0.0;
  EXPECT_THROW(static_cast<void>(confirm_gait(travelling_wave(1.0), few,
                                              [&](double share) {
                                                EXPECT_GE(share, last);
                                                last = share;
                                                return share > 0.45;
                                              })),
               SearchEnded);
  EXPECT_LT(last, 0.6);
}

}  // namespace
}  // namespace proleg::optimize
