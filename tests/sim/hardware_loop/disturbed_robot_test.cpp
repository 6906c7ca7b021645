// Servos that act late, and touch sensors that read wrong, with modules in the loop.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {
namespace {

TEST(ServoLatency, HoldsForTheEndOfPulsesToo) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.robot.servo.latency_us = 20'000;
  HardwareOptions options;
  options.restarts = {{50, 2}};
  HardwareLoop loop(scenario, std::move(options));
  constexpr std::uint16_t idle_ma = 10;
  std::vector<std::uint32_t> limp_ticks;
  while (loop.tick() < 80) {
    loop.advance();
    if (loop.tick() > 40 && loop.plant().servo_readings(2).current_ma == idle_ma) {
      limp_ticks.push_back(loop.tick() - 1);
    }
  }
  ASSERT_FALSE(limp_ticks.empty());
  EXPECT_EQ(limp_ticks.front(), 52U) << "the module is gone at tick 50";
  EXPECT_LT(limp_ticks.back(), 79U);
}

TEST(ContactNoise, AndLatencyAreTheSameForModulesInTheLoop) {
  Scenario scenario = shipped("obstacle/reflex");
  scenario.contact_noise = 0.05;
  scenario.robot.servo.latency_us = 3'000;
  Simulation simulation(scenario);
  HardwareLoop loop(scenario, {});
  while (loop.tick() < 300) {
    loop.advance();
    simulation.advance();
  }
  EXPECT_EQ(loop.differences(), 0U);
  EXPECT_EQ(loop.setpoint_hash().hex(), simulation.setpoint_hash().hex());
  EXPECT_EQ(loop.plant().displacement(), simulation.plant().displacement());
  EXPECT_TRUE(std::ranges::equal(loop.plant().link_contacts(), simulation.plant().link_contacts()));

  Scenario without_noise = scenario;
  without_noise.contact_noise = 0.0;
  Simulation undisturbed(without_noise);
  while (undisturbed.tick() < 300) {
    undisturbed.advance();
  }
  EXPECT_NE(simulation.setpoint_hash().hex(), undisturbed.setpoint_hash().hex()) << "the reflex reads them";
}

}  // namespace
}  // namespace proleg::sim
