// Servos and world with modules in the loop: the same as in the simulation, whenever the pulses start.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "shared/kernel/servo_pulses.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/hardware_loop/plant_ticks.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"

namespace proleg::sim {
namespace {

// Everything about a world that is not in its hashes.
struct WorldState {
  std::vector<double> numbers;
  std::uint64_t differences = 0;
};

void append(const Plant& plant, std::vector<double>& numbers) {
  for (const Pose& pose : plant.link_poses()) {
    for (const double number : {pose.position.x(), pose.position.y(), pose.position.z(), pose.orientation.w(),
                                pose.orientation.x(), pose.orientation.y(), pose.orientation.z()}) {
      numbers.push_back(number);
    }
  }
}

WorldState world_with_modules(const Scenario& scenario, std::uint32_t ticks, HardwareOptions options = {}) {
  HardwareLoop loop(scenario, std::move(options));
  WorldState state;
  while (loop.tick() < ticks) {
    loop.advance();
    append(loop.plant(), state.numbers);
  }
  state.differences = loop.differences();
  return state;
}

WorldState simulated_world(const Scenario& scenario, std::uint32_t ticks) {
  Simulation simulation(scenario);
  WorldState state;
  while (simulation.tick() < ticks) {
    simulation.advance();
    append(simulation.plant(), state.numbers);
  }
  return state;
}

Scenario timed(const char* name, std::uint32_t tick_us, std::uint32_t steps, std::uint32_t servo_us) {
  Scenario scenario = shipped(name);
  scenario.kernel.tick_period_us = tick_us;
  scenario.step_s = tick_us * 1e-6 / steps;
  scenario.robot.servo.period_us = servo_us;
  return scenario;
}

TEST(PulseTiming, TheWorldWithModulesIsThatOfTheSimulationForEveryStepOfThePhysics) {
  const std::uint32_t seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto pick = [&](const auto& values) {
    return values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random)];
  };
  for (int run = 0; run < 40; ++run) {
    const std::uint32_t tick_us = pick(std::array{2'000U, 5'000U, 7'000U, 10'000U, 13'000U});
    const std::uint32_t steps = pick(std::array{2U, 7U, 10U, 20U, 40U, 100U});
    const std::uint32_t servo_us = std::uniform_int_distribution(200U, 12'000U)(random);
    const char* const name = pick(std::array{"travelling_wave/coupled", "obstacle/reflex"});
    const Scenario scenario = timed(name, tick_us, steps, servo_us);
    const WorldState modules = world_with_modules(scenario, 60);
    const std::string what = std::string(name) + ", tick " + std::to_string(tick_us) + " us, " + std::to_string(steps) +
                             " steps, servo period " + std::to_string(servo_us) + " us";
    EXPECT_EQ(modules.differences, 0U) << what;
    EXPECT_EQ(modules.numbers, simulated_world(scenario, 60).numbers) << what;
  }
}

// Crystals that are off by percents shift SYNCs, intervals and pulses by tenths of a tick. No real crystal does.
TEST(PulseTiming, AWorldThatDiffersIsReportedAsADifference) {
  unsigned different = 0;
  for (const std::uint32_t servo_us : {400U, 981U, 1'000U}) {
    const Scenario scenario = timed("travelling_wave/uniform", 10'000, 100, servo_us);
    const std::vector<double> expected = simulated_world(scenario, 100).numbers;
    for (const std::uint32_t error_ppm : {1'000U, 20'000U, 80'000U}) {
      HardwareOptions options;
      options.crystal_error_ppm = error_ppm;
      const WorldState modules = world_with_modules(scenario, 100, options);
      const bool differs = modules.numbers != expected;
      EXPECT_TRUE(!differs || modules.differences > 0) << servo_us << " us, " << error_ppm << " ppm";
      different += differs ? 1U : 0U;
    }
  }
  EXPECT_GT(different, 0U) << "the test shows nothing if all worlds are the same";
}

// With the odd periods, pulses start between the start of a tick's last step and the end of the tick.
TEST(PulseTiming, TheMeasuresWithModulesAreThoseOfTheSimulation) {
  Scenario scenario = shipped("travelling_wave/coupled");
  for (const std::uint32_t servo_period_us : {700U, 981U, 1'999U, 3'333U, scenario.robot.servo.period_us}) {
    scenario.robot.servo.period_us = servo_period_us;
    HardwareLoop loop(scenario, {});
    while (loop.tick() < 400) {
      loop.advance();
    }
    const MeasureValues modules = loop.plant().meter().values();
    Simulation simulation(scenario);
    while (simulation.tick() < 400) {
      simulation.advance();
    }
    const MeasureValues memory = simulation.measures();
    for (const MeasureDeclaration& declaration : measures()) {
      EXPECT_EQ(modules[declaration.measure], memory[declaration.measure])
          << declaration.name << " with a servo period of " << servo_period_us << " us";
    }
  }
}

TEST(PlantTicks, AnnounceEachReadingAndEachStepBefore) {
  constexpr std::uint64_t steps = 20;
  const Scenario scenario = timed("travelling_wave/uniform", 10'000, steps, 3'000);
  Plant plant(scenario);
  struct Announcement {
    BusTime time;
    std::uint64_t steps_before;
    unsigned readings = 0;  ///< of pulses, up to the next one
  };
  std::vector<Announcement> announcements{{0, 0}};
  PlantTicks ticks(
      scenario, plant,
      [&](std::uint32_t) {
        ++announcements.back().readings;
        return servo_center;
      },
      [&](BusTime now) {
        announcements.push_back({now, plant.drawn_current(0).steps});
      });
  ticks.begin(0, 0);
  constexpr BusTime early_sync = 9'400'000;
  while (ticks.next_event() < early_sync) {
    ticks.advance_to(ticks.next_event());
  }
  ticks.end(early_sync);
  ticks.complete();
  EXPECT_EQ(announcements.front().readings, 0U) << "nothing was announced";
  std::vector<BusTime> readings;
  std::vector<BusTime> last_before_step(steps + 1);
  for (const Announcement& announcement : announcements) {
    if (announcement.readings > 0) {
      EXPECT_EQ(announcement.readings, scenario.robot.joints.size());
      readings.push_back(announcement.time);
    }
    last_before_step[announcement.steps_before] = announcement.time;
  }
  EXPECT_EQ(readings, (std::vector<BusTime>{500'000, 3'500'000, 6'500'000, 9'500'000}));
  EXPECT_EQ(last_before_step[0], 500'000U) << "after the reading on which the servos act";
  for (std::uint64_t step = 1; step < steps; ++step) {
    EXPECT_GE(last_before_step[step], last_before_step[step - 1]);
    EXPECT_NEAR(static_cast<double>(last_before_step[step]), 250e3 + 500e3 * static_cast<double>(step), 400e3);
  }
  EXPECT_EQ(last_before_step[steps - 1], early_sync) << "the rest of the steps";
  EXPECT_EQ(last_before_step[steps], 9'500'000U) << "the last pulses of the tick";
}

// Two ticks of 10 ms with steps of 0.5 ms. The servos' intervals start every 3 ms, the last one of the first tick at
// 9 ms. Its pulse is read at 9.5 ms.
class EarlySync : public testing::Test {
 protected:
  std::size_t late_readings_if_the_sync_comes_at(BusTime sync) {
    PlantTicks ticks(scenario_, plant_, [](std::uint32_t) { return servo_center; });
    ticks.begin(0, 0);
    ticks.advance_to(sync - 1);
    ticks.end(sync);
    ticks.complete();
    return ticks.late_readings().size();
  }

  Scenario scenario_ = timed("travelling_wave/uniform", 10'000, 20, 3'000);
  Plant plant_{scenario_};
};

TEST_F(EarlySync, LosesNoPulseWithinTheTimeThatASyncMayBeEarly) {
  EXPECT_EQ(late_readings_if_the_sync_comes_at(10'000'000), 0U);
  EXPECT_EQ(late_readings_if_the_sync_comes_at(9'600'000), 0U);
}

TEST_F(EarlySync, BeforeTheReadingOfAPulseThatAStepNeedsMakesThePulseLate) {
  EXPECT_EQ(late_readings_if_the_sync_comes_at(9'400'000), scenario_.robot.joints.size());
}

}  // namespace
}  // namespace proleg::sim
