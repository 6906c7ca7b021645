// The shipped scenarios in the reduced engine. Oracle: ODE.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine_run.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

TEST(ReducedEngine, TheShippedGaitsCrawlAsFarAsInOde) {
  for (const char* name : {"travelling_wave/uniform", "travelling_wave/tail_fixed"}) {
    const EngineRun ode = run_in(PhysicsEngine::ode, name);
    const EngineRun reduced = run_in(PhysicsEngine::reduced, name);
    EXPECT_GT(ode.distance, 1.0) << name;
    EXPECT_NEAR(reduced.distance / ode.distance, 1.0, 0.04) << name;
    EXPECT_EQ(reduced.setpoints, ode.setpoints) << name;
    EXPECT_FALSE(ode.world) << name;
    EXPECT_EQ(reduced.world, run_in(PhysicsEngine::reduced, name).world) << name;
    EXPECT_EQ(reduced.world.value_or("").size(), 64U) << name;
  }
}

TEST(ReducedEngine, OnTheTerraceThePlainGaitStaysAndTheReflexCrosses) {
  EXPECT_LT(run_in(PhysicsEngine::reduced, "obstacle/plain").distance, 0.4);
  EXPECT_GT(run_in(PhysicsEngine::reduced, "obstacle/reflex").distance, 1.7);
}

/// In the reduced engine, with the masses of its middle links times this.
Scenario with_light_middle(double factor, const std::string& amplitude) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.environment.engine = PhysicsEngine::reduced;
  apply_setting(scenario, "amplitude=" + amplitude);
  for (std::size_t link = 1; link + 1 < scenario.robot.links.size(); ++link) {
    MassProperties& mass = scenario.robot.links[link].mass;
    mass.mass *= factor;
    mass.inertia *= factor;
  }
  return scenario;
}

TEST(ReducedEngine, AWorldThatExplodesNamesItsTickAndTouchesNoOtherInItsBatch) {
  constexpr std::uint32_t ticks = 500;
  constexpr double explosive = 1e-5;  // 1 mg between ends of 50 g
  std::vector<Scenario> scenarios;
  for (const char* amplitude : {"20", "30", "40", "50", "60"}) {
    const bool explodes = scenarios.size() % 2 == 1;
    scenarios.push_back(with_light_middle(explodes ? explosive : 1.0, explodes ? "40" : amplitude));
  }
  scenarios[1].environment.gravity.z() *= 2.0;
  std::vector<const Scenario*> members;
  for (const Scenario& scenario : scenarios) {
    members.push_back(&scenario);
  }
  SimulationBatch batch(members);
  std::vector<std::uint32_t> ends(scenarios.size(), ticks);
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    batch.advance();
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
      ends[i] = batch.runs(i) ? ticks : std::min(ends[i], tick);
    }
  }
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    Simulation alone(scenarios[i]);
    const std::string failure = message_of<PhysicsError>([&] {
      while (alone.tick() < ticks) {
        alone.advance();
      }
    });
    if (i % 2 == 1) {
      EXPECT_EQ(batch.failure(i), failure);
      EXPECT_EQ(failure.find("tick " + std::to_string(ends[i]) + " ("), 0U) << failure;
      EXPECT_NE(failure.find("the simulation became unstable"), std::string::npos) << failure;
    } else {
      EXPECT_EQ(batch.failure(i), "");
      EXPECT_EQ(batch.simulation(i).plant().world().state(), alone.plant().world().state()) << i;
      EXPECT_EQ(batch.simulation(i).measures()[Measure::distance], alone.measures()[Measure::distance]) << i;
    }
  }
  EXPECT_NE(ends[1], ends[3]);
}

}  // namespace
}  // namespace proleg::sim
