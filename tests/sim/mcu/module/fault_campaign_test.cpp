// Random faults for modules that run the flashed image in virtual chips: the rules of motion hold, and where the faults
// act at ticks, set-points and pulses are those of native modules.
//
// Schedule n has the seed n. PROLEG_FAULTS_FIRST and PROLEG_FAULTS_RUNS choose the schedules.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <string>

#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/fault_run.hpp"
#include "tests/support/from_environment.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

constexpr double duration_s = 5.0;
constexpr std::array scenarios{"travelling_wave/uniform", "travelling_wave/coupled", "obstacle/reflex"};

/// With the servo period of common servos. (The shipped one is shorter than a pulse: the pin of a chip then shows only
/// some of the pulses.)
Scenario scenario_of(std::uint32_t seed) {
  Scenario scenario = shipped(scenarios[seed % scenarios.size()]);
  scenario.robot.servo.period_us = 20'000;
  return scenario;
}

FaultRunResult run_image(const Scenario& scenario, const FaultSchedule& schedule, std::uint32_t ticks) {
  return run_with_faults(scenario, schedule, ticks, [](const ModuleParts& parts) {
    return std::make_unique<VirtualModule>(parts, flashed_image(), VirtualModuleOptions{});
  });
}

struct Campaign {
  FaultStatistics statistics;
  std::uint32_t compared = 0;
  std::uint32_t identical = 0;
};

Campaign run_campaign(bool only_at_ticks) {
  const std::uint32_t first = from_environment("PROLEG_FAULTS_FIRST", 1);
  const std::uint32_t runs = from_environment("PROLEG_FAULTS_RUNS", 6);
  Campaign campaign;
  for (std::uint32_t seed = first; seed < first + runs; ++seed) {
    const Scenario scenario = scenario_of(seed);
    const auto ticks = static_cast<std::uint32_t>(duration_s * 1e6 / scenario.kernel.tick_period_us);
    RandomFaults settings;
    settings.seed = seed;
    settings.has_chips = true;
    settings.only_at_ticks = only_at_ticks;
    const FaultSchedule schedule = random_faults(settings, scenario);
    const FaultRunResult image = run_image(scenario, schedule, ticks);
    campaign.statistics.add(schedule, image);
    for (const std::string& violation : image.violations) {
      ADD_FAILURE() << "seed " << seed << ": " << violation << "\n" << faults_text(schedule, scenario.robot);
    }
    if (!can_play_natively(schedule)) {
      continue;
    }
    const FaultRunResult native = run_with_faults(scenario, schedule, ticks);
    const bool is_identical = native.setpoint_hash == image.setpoint_hash && native.servo_hash == image.servo_hash;
    ++campaign.compared;
    campaign.identical += is_identical ? 1U : 0U;
    if (act_at_ticks(schedule, scenario.kernel.tick_period_us)) {
      EXPECT_TRUE(is_identical) << "seed " << seed << "\n" << faults_text(schedule, scenario.robot);
    }
  }
  const MotionWatch::Worst& worst = campaign.statistics.worst;
  std::printf("%u schedules, %u faults, %u broken; %u played by native modules too, %u of them identical\n",
              campaign.statistics.runs, campaign.statistics.faults, campaign.statistics.broken_runs, campaign.compared,
              campaign.identical);
  std::printf(
      "worst: change between pulses %.3f of what the greatest speed allows; %.3f degrees inside the limits; "
      "motion %.3f of 1.500 s after the last command\n",
      worst.change_steps, -worst.beyond_limit_deg, worst.motion_after_command_s);
  return campaign;
}

TEST(ImageFaultCampaign, KeepsMotionBoundedWhateverFails) {
  const Campaign campaign = run_campaign(false);
  EXPECT_EQ(campaign.statistics.joints_ended[static_cast<std::size_t>(JointEnd::unsafe)], 0U);
}

// The chips have no brown-out reset. Each module's supply falls once or twice, to any voltage, and rises again.
TEST(ImageFaultCampaign, NoRampOfTheSupplyEndsUnsafeOrWithAClockThatIsTooFast) {
  const std::uint32_t first = from_environment("PROLEG_FAULTS_FIRST", 1);
  const std::uint32_t runs = from_environment("PROLEG_FAULTS_RUNS", 6);
  FaultStatistics statistics;
  for (std::uint32_t seed = first; seed < first + runs; ++seed) {
    const Scenario scenario = scenario_of(seed);
    const auto ticks = static_cast<std::uint32_t>(duration_s * 1e6 / scenario.kernel.tick_period_us);
    std::mt19937 random(seed);
    const auto between = [&](std::uint32_t low, std::uint32_t high) {
      return low + static_cast<std::uint32_t>(random() % (high - low));
    };
    FaultSchedule schedule;
    for (unsigned joint = 0; joint < scenario.modules.size(); ++joint) {
      for (const std::uint32_t start_us : {500'000U, 1'700'000U}) {
        Fault fault;
        fault.kind = FaultKind::supply;
        fault.joint = joint;
        fault.start_us = between(start_us, start_us + 600'000);
        fault.duration_us = between(1'000, 500'000);
        fault.amount = between(1'500, 2'950);
        schedule.push_back(fault);
      }
    }
    const FaultRunResult result = run_image(scenario, schedule, ticks);
    statistics.add(schedule, result);
    for (const std::string& violation : result.violations) {
      ADD_FAILURE() << "seed " << seed << ": " << violation << "\n" << faults_text(schedule, scenario.robot);
    }
  }
  std::printf("%u schedules, %u faults, %u broken\n", statistics.runs, statistics.faults, statistics.broken_runs);
  EXPECT_EQ(statistics.joints_ended[static_cast<std::size_t>(JointEnd::unsafe)], 0U);
}

TEST(ImageFaultCampaign, FaultsThatActAtTicksLeaveTheImageIdenticalToNativeModules) {
  const Campaign campaign = run_campaign(true);
  EXPECT_EQ(campaign.compared, campaign.statistics.runs);
  EXPECT_EQ(campaign.identical, campaign.statistics.runs);
}

}  // namespace
}  // namespace proleg::sim
