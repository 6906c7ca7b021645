// Servos that act late, and touch sensors that read wrong.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {
namespace {

/// Only its servos move it, so a latency delays the whole motion.
Scenario floating(std::uint32_t latency_us) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.environment.objects.clear();
  scenario.environment.gravity.setZero();
  scenario.robot.servo.latency_us = latency_us;
  return scenario;
}

/// Joint angles at the end of each tick.
std::vector<std::vector<double>> angles_of(const Scenario& scenario, int ticks) {
  Simulation simulation(scenario);
  std::vector<std::vector<double>> angles;
  for (int i = 0; i < ticks; ++i) {
    simulation.advance();
    angles.emplace_back(simulation.plant().joint_angles().begin(), simulation.plant().joint_angles().end());
  }
  return angles;
}

TEST(ServoLatency, DelaysTheWholeMotion) {
  const auto prompt = angles_of(floating(0), 50);
  for (const int ticks : {1, 2, 10}) {
    const auto late = angles_of(floating(static_cast<std::uint32_t>(ticks) * 10'000U), 50);
    for (std::size_t tick = 0; tick < 50; ++tick) {
      for (std::size_t joint = 0; joint < 5; ++joint) {
        const double expected =
            tick < static_cast<std::size_t>(ticks) ? 0.0 : prompt[tick - static_cast<std::size_t>(ticks)][joint];
        EXPECT_NEAR(late[tick][joint], expected, 1e-12) << ticks << " ticks late, tick " << tick << ", joint " << joint;
      }
    }
  }
}

TEST(ServoLatency, IsRoundedToStepsOfThePhysics) {
  const auto steps = [](std::uint32_t latency_us) { return angles_of(floating(latency_us), 20); };
  EXPECT_EQ(steps(400), steps(0));
  EXPECT_NE(steps(600), steps(0));
  EXPECT_EQ(steps(600), steps(1'000));
  EXPECT_EQ(steps(1'499), steps(1'000));
}

TEST(ServoLatency, ChangesNoSetpointNorPulse) {
  Scenario scenario = shipped("travelling_wave/uniform");
  Simulation prompt(scenario);
  Scenario late_scenario = scenario;
  late_scenario.robot.servo.latency_us = 30'000;
  Simulation late(late_scenario);
  for (int i = 0; i < 100; ++i) {
    prompt.advance();
    late.advance();
    EXPECT_TRUE(std::ranges::equal(prompt.plant().servo_commands(), late.plant().servo_commands()))
        << "the last pulse taken, not the one acted on";
  }
  EXPECT_EQ(prompt.setpoint_hash().hex(), late.setpoint_hash().hex());
  EXPECT_EQ(prompt.servo_hash().hex(), late.servo_hash().hex());
  EXPECT_NE(prompt.plant().displacement(), late.plant().displacement());
}

/// Sensors of all links at the end of each tick.
std::vector<std::vector<std::uint8_t>> sensors_of(const Scenario& scenario, int ticks) {
  Simulation simulation(scenario);
  std::vector<std::vector<std::uint8_t>> sensors;
  for (int i = 0; i < ticks; ++i) {
    simulation.advance();
    sensors.emplace_back(simulation.plant().link_contacts().begin(), simulation.plant().link_contacts().end());
  }
  return sensors;
}

Scenario noisy(double probability, std::uint64_t seed = 1) {
  Scenario scenario = shipped("travelling_wave/uniform");  // reads no contacts, so that its motion stays the same
  scenario.contact_noise = probability;
  scenario.kernel.seed = seed;
  return scenario;
}

TEST(ContactNoise, MakesEverySensorReadWrongWithItsProbability) {
  constexpr int ticks = 500;
  const auto truth = sensors_of(noisy(0.0), ticks);
  for (const double probability : {0.01, 0.2, 1.0}) {
    const auto sensors = sensors_of(noisy(probability), ticks);
    for (std::size_t link = 0; link < 6; ++link) {
      for (const unsigned bit : {1U, 2U}) {
        int wrong = 0;
        for (std::size_t tick = 0; tick < ticks; ++tick) {
          wrong += ((sensors[tick][link] ^ truth[tick][link]) & bit) != 0 ? 1 : 0;
        }
        // Five standard deviations of a binomial distribution.
        EXPECT_NEAR(wrong, probability * ticks, 5 * std::sqrt(ticks * probability * (1 - probability)) + 1e-9)
            << "link " << link << ", bit " << bit;
      }
    }
  }
}

TEST(ContactNoise, IsTheSameForTheSameSeed) {
  EXPECT_EQ(sensors_of(noisy(0.1, 5), 100), sensors_of(noisy(0.1, 5), 100));
  EXPECT_NE(sensors_of(noisy(0.1, 5), 100), sensors_of(noisy(0.1, 6), 100));
}

TEST(ContactNoise, DoesNotChangeTheMeasures) {
  const Scenario undisturbed = noisy(0.0);
  const Scenario disturbed = noisy(0.5);
  Simulation quiet(undisturbed);
  Simulation loud(disturbed);
  for (int i = 0; i < 200; ++i) {
    quiet.advance();
    loud.advance();
  }
  EXPECT_EQ(quiet.link_duty_factors(), loud.link_duty_factors()) << "they use the contacts without noise";
  EXPECT_EQ(quiet.measures()[Measure::stability_margin], loud.measures()[Measure::stability_margin]);
}

}  // namespace
}  // namespace proleg::sim
