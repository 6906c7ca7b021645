#include "tools/proleg/ui/ghost.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::tools {
namespace {

/// The simulated robot of `proleg simulate` after so many ticks, and the ghost that gets its pulses.
TEST(Ghost, MovesAsTheSimulationWithTheSamePulses) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::Simulation simulation(scenario);
  Ghost ghost(scenario);
  constexpr int ticks = 300;
  for (int tick = 0; tick < ticks; ++tick) {
    simulation.advance();
    const sim::TickSample sample = simulation.sample();
    ghost.follow(sample.tick, {sample.servo_pulses.begin(), sample.servo_pulses.end()});
  }
  const auto differs = [&] {
    const std::optional<Ghost::State> state = ghost.state();
    double largest = state ? 0.0 : 10.0;
    for (std::size_t joint = 0; state && joint < state->joint_angles.size(); ++joint) {
      largest = std::max(largest, std::abs(state->joint_angles[joint] - simulation.plant().joint_angles()[joint]));
    }
    return largest;
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (differs() > 0.02 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_LT(differs(), 0.02) << "rad; the ghost has ramped in to its start";
  EXPECT_FALSE(ghost.take_failure());
}

TEST(Ghost, IsGivenUpWhenItIsTooFarBehind) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  Ghost ghost(scenario);
  std::optional<std::string> failure;
  for (std::uint32_t tick = 0; tick < 100'000 && !failure; ++tick) {
    ghost.follow(tick, {});
    failure = ghost.take_failure();
  }
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("more slowly"), std::string::npos);
  EXPECT_FALSE(ghost.state());
  EXPECT_FALSE(ghost.take_failure()) << "it is said once";
}

}  // namespace
}  // namespace proleg::tools
