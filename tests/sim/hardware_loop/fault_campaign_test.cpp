// Random faults: whatever fails, motion stays bounded and each module ends in operation or in a safe state.
//
// Schedule n has the seed n. PROLEG_FAULTS_FIRST and PROLEG_FAULTS_RUNS choose the schedules. The test prints counts
// and the values that come nearest to a bound.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "shipped.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/fault_run.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::sim {
namespace {

constexpr std::array scenarios{"travelling_wave/uniform", "travelling_wave/coupled", "obstacle/reflex"};

/// Most with the servo period of common servos, some with the shipped one of 1 ms. Coarse steps of the physics: what
/// counts here are pulses and frames.
Scenario scenario_of(std::uint32_t seed) {
  Scenario scenario = shipped(scenarios[seed % scenarios.size()]);
  scenario.step_s = 0.002;
  if (seed % 4 != 0) {
    scenario.robot.servo.period_us = 20'000;
  }
  return scenario;
}

TEST(FaultCampaign, KeepsMotionBoundedWhateverFails) {
  const std::uint32_t first = from_environment("PROLEG_FAULTS_FIRST", 1);
  const std::uint32_t runs = from_environment("PROLEG_FAULTS_RUNS", PROLEG_FAULT_RUNS);
  FaultStatistics statistics;
  for (std::uint32_t seed = first; seed < first + runs; ++seed) {
    const Scenario scenario = scenario_of(seed);
    constexpr double run_us = 5e6;
    const auto ticks = static_cast<std::uint32_t>(run_us / scenario.kernel.tick_period_us);
    RandomFaults settings;
    settings.seed = seed;
    const FaultSchedule schedule = random_faults(settings, scenario);
    const FaultRunResult result = run_with_faults(scenario, schedule, ticks);
    statistics.add(schedule, result);
    for (const std::string& violation : result.violations) {
      ADD_FAILURE() << scenarios[seed % scenarios.size()] << ", seed " << seed << ": " << violation << "\n"
                    << faults_text(schedule, scenario.robot);
    }
  }
  const auto ended = [&](JointEnd end) { return statistics.joints_ended[static_cast<std::size_t>(end)]; };
  std::printf("%u schedules, %u faults; joints ended: operation %u, hold %u, limp %u, silent %u, unsafe %u\n",
              statistics.runs, statistics.faults, ended(JointEnd::operation), ended(JointEnd::hold),
              ended(JointEnd::limp), ended(JointEnd::silent), ended(JointEnd::unsafe));
  std::printf(
      "worst: change between pulses %.3f of what the greatest speed allows; %.3f degrees inside the limits; "
      "motion %.3f of 1.500 s after the last command\n",
      statistics.worst.change_steps, -statistics.worst.beyond_limit_deg, statistics.worst.motion_after_command_s);
  EXPECT_EQ(statistics.broken_runs, 0U);
  EXPECT_EQ(ended(JointEnd::unsafe), 0U);
}

}  // namespace
}  // namespace proleg::sim
