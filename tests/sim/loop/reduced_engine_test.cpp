// The shipped scenarios in the reduced engine. Oracle: ODE.

#include <gtest/gtest.h>

#include "engine_run.hpp"

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

}  // namespace
}  // namespace proleg::sim
