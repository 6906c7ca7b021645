#include "sim/optimize/confirm/gait_confirmation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

sim::Scenario wave(sim::PhysicsEngine engine) {
  sim::DiskFiles files;
  sim::Scenario scenario =
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
  scenario.environment.engine = engine;
  scenario.duration_s = 3.0;
  return scenario;
}

constexpr WorldVariation tenth{.spread = {.friction = 0.1, .mass = 0.1}, .start_m = 0.005};
void no_progress(double /*share*/) {}

TEST(PerturbedWorlds, GiveTheScenariosOwnDistanceWhereNothingDiffers) {
  for (const sim::PhysicsEngine engine : {sim::PhysicsEngine::ode, sim::PhysicsEngine::reduced}) {
    const WorldDistances worlds = distances_in_worlds(wave(engine), 3, 1, {}, no_progress);
    ASSERT_EQ(worlds.distances.size(), 3U);
    EXPECT_EQ(worlds.distances.front(), worlds.distances.back());
    EXPECT_GT(worlds.distances.front(), 0.1);
  }
}

TEST(PerturbedWorlds, AreTheSameForTheSameSeedAndOthersForAnother) {
  const sim::Scenario scenario = wave(sim::PhysicsEngine::reduced);
  const WorldDistances first = distances_in_worlds(scenario, 20, 7, tenth, no_progress);
  ASSERT_EQ(first.distances.size(), 20U);
  EXPECT_EQ(first.failed, 0U);
  EXPECT_TRUE(std::ranges::is_sorted(first.distances));
  EXPECT_GT(first.distances.back() - first.distances.front(), 0.001);
  EXPECT_EQ(first.distances, distances_in_worlds(scenario, 20, 7, tenth, no_progress).distances);
  EXPECT_NE(first.distances, distances_in_worlds(scenario, 20, 8, tenth, no_progress).distances);
}

TEST(PerturbedWorlds, SayHowFarTheyAre) {
  double last = 0.0;
  static_cast<void>(distances_in_worlds(wave(sim::PhysicsEngine::reduced), 20, 1, tenth, [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  }));
  EXPECT_DOUBLE_EQ(last, 1.0);
}

}  // namespace
}  // namespace proleg::optimize
