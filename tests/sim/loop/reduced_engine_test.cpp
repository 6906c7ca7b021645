// The shipped scenarios in the reduced engine. Oracle: ODE.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {
namespace {

constexpr double whole_run_s = 30;

struct EngineRun {
  double distance;  // m
  std::string setpoints;
  std::optional<std::string> world;
};

EngineRun run_in(PhysicsEngine engine, const std::string& name) {
  Scenario scenario = shipped(name);
  scenario.environment.engine = engine;
  Simulation simulation(scenario);
  while (simulation.time_s() < whole_run_s - 1e-9) {
    simulation.advance();
  }
  return {simulation.plant().displacement(), simulation.setpoint_hash().hex(), simulation.world_hash()};
}

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

}  // namespace
}  // namespace proleg::sim
