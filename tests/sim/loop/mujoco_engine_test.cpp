// The shipped scenarios in MuJoCo. Oracle: ODE.

#include <gtest/gtest.h>

#include "engine_run.hpp"
#include "sim/mujoco/mujoco_world.hpp"

namespace proleg::sim {
namespace {

class MujocoEngine : public testing::Test {
 protected:
  void SetUp() override {
    if (!mujoco::is_built_in()) {
      GTEST_SKIP() << "built without MuJoCo";
    }
  }
};

TEST_F(MujocoEngine, TheShippedGaitsCrawlAsFarAsInOde) {
  for (const char* name : {"travelling_wave/uniform", "travelling_wave/tail_fixed"}) {
    const EngineRun ode = run_in(PhysicsEngine::ode, name);
    const EngineRun mujoco = run_in(PhysicsEngine::mujoco, name);
    EXPECT_NEAR(mujoco.distance / ode.distance, 1.0, 0.04) << name;
    EXPECT_EQ(mujoco.setpoints, ode.setpoints) << name;
    EXPECT_FALSE(mujoco.world) << name;
    EXPECT_EQ(mujoco.distance, run_in(PhysicsEngine::mujoco, name).distance) << name;
  }
}

// The reflex acts on touch sensors.
TEST_F(MujocoEngine, OnTheTerraceThePlainGaitStaysAndTheReflexCrosses) {
  EXPECT_LT(run_in(PhysicsEngine::mujoco, "obstacle/plain").distance, 0.4);
  EXPECT_GT(run_in(PhysicsEngine::mujoco, "obstacle/reflex").distance, 1.7);
}

}  // namespace
}  // namespace proleg::sim
