// The image that is flashed, in virtual chips on the simulated bus: no bit of what they do may differ from the
// gait in memory.

#include "sim/mcu/module/virtual_module.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <tuple>

#include "sim/scenario/losses.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

struct Simulated {
  std::string setpoints;
  std::string servo_commands;
  double displacement;
};

Simulated simulated(const Scenario& scenario, std::uint32_t ticks, const Losses* losses = nullptr) {
  Simulation simulation(scenario, losses);
  while (simulation.tick() < ticks) {
    simulation.advance();
  }
  return {simulation.setpoint_hash().hex(), simulation.servo_hash().hex(), simulation.plant().displacement()};
}

void expect_identical(VirtualRobot& robot, const Simulated& expected) {
  EXPECT_EQ(robot.loop().differences(), 0U);
  EXPECT_EQ(robot.loop().setpoint_hash().hex(), expected.setpoints);
  EXPECT_EQ(robot.loop().servo_hash().hex(), expected.servo_commands);
  EXPECT_EQ(robot.loop().plant().displacement(), expected.displacement) << "the worlds are the same, too";
  EXPECT_TRUE(robot.loop().failures().empty());
}

class EveryScenario : public testing::TestWithParam<std::tuple<const char*, std::uint32_t>> {};

TEST_P(EveryScenario, CrawlsBitForBitLikeTheSimulation) {
  const auto& [name, ticks] = GetParam();
  VirtualRobot robot(shipped(name));
  robot.run_to(ticks);
  expect_identical(robot, simulated(robot.scenario(), ticks));
}

TEST_P(EveryScenario, LosesTheFramesThatTheSimulationLoses) {
  const auto& [name, ticks] = GetParam();
  const Scenario scenario = shipped(name);
  const Losses losses(RandomLosses{7, 214'748'365});
  HardwareOptions options;
  options.losses = &losses;
  VirtualRobot robot(scenario, std::move(options));
  robot.run_to(ticks);
  EXPECT_GT(robot.loop().lost_frames(), 0U);
  expect_identical(robot, simulated(scenario, ticks, &losses));
}

TEST_P(EveryScenario, AModuleThatIsResetRejoinsAndNothingDiffers) {
  const auto& [name, ticks] = GetParam();
  HardwareOptions options;
  options.restarts = {{ticks / 3, 2}};
  VirtualRobot robot(shipped(name), std::move(options));
  robot.run_to(ticks);
  EXPECT_EQ(robot.loop().differences(), 0U);
  ASSERT_EQ(robot.joined.size(), 1U);
  EXPECT_EQ(robot.joined[0].first, 2U);
  EXPECT_LT(robot.joined[0].second, ticks / 3 + 40);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario,
                         testing::Values(std::tuple("travelling_wave/uniform", 800),
                                         std::tuple("travelling_wave/tail_fixed", 800),
                                         std::tuple("travelling_wave/coupled", 800), std::tuple("obstacle/plain", 800),
                                         std::tuple("obstacle/reflex", 1500), std::tuple("long_chain/twenty", 200)));

TEST(VirtualModule, MixesWithNativeOnes) {
  VirtualRobot robot(shipped("obstacle/reflex"), {}, [](unsigned joint) { return joint == 1 || joint == 3; });
  robot.run_to(800);
  expect_identical(robot, simulated(robot.scenario(), 800));
}

TEST(VirtualModule, WorksWithServosAndTicksOfManyPeriods) {
  for (const std::uint32_t servo_period : {700U, 1'000U, 3'300U, 20'000U}) {
    for (const std::uint32_t tick_period : {5'000U, 10'000U, 20'000U}) {
      SCOPED_TRACE("servo " + std::to_string(servo_period) + " us, tick " + std::to_string(tick_period) + " us");
      Scenario scenario = shipped("travelling_wave/coupled");
      scenario.robot.servo.period_us = servo_period;
      scenario.kernel.tick_period_us = tick_period;
      VirtualRobot robot(scenario);
      robot.run_to(100);
      expect_identical(robot, simulated(scenario, 100));
    }
  }
}

TEST(VirtualModule, TwoRunsAreEqualInEverythingThatIsRecordedAndInEveryFrameAndItsTime) {
  const auto run = [] {
    std::ostringstream everything;
    HardwareOptions options;
    options.restarts = {{150, 1}};
    options.on_frame = [&everything](const Transmission& frame) {
      everything << frame.end << ' ' << frame.frame.identifier;
      for (const std::uint8_t byte : frame.frame.bytes()) {
        everything << ' ' << unsigned{byte};
      }
      everything << '\n';
    };
    VirtualRobot robot(shipped("obstacle/reflex"), std::move(options));
    robot.run_to(300);
    for (const TickCost& cost : robot.costs) {
      everything << cost.tick << ' ' << cost.to_state_frame << ' ' << cost.whole << '\n';
    }
    return everything.str();
  };
  EXPECT_EQ(run(), run());
}

TEST(VirtualModule, NeedsFarLessThan20000InstructionsFromSyncToTheStateFrame) {
  VirtualRobot robot(shipped("long_chain/twenty"));
  robot.run_to(150);
  std::uint64_t worst = 0;
  for (unsigned joint = 0; joint < 20; ++joint) {
    const TickCost& cost = robot.module(joint).worst_tick();
    EXPECT_GT(cost.to_state_frame, 300U) << "it does compute";
    worst = std::max(worst, cost.to_state_frame);
  }
  EXPECT_LE(worst, 20'000U);
  std::cout << "instructions from SYNC to the state frame, 20 joints: at most " << worst << '\n';
}

TEST(VirtualModule, MonitorsTheMeanCurrentOfTheTickAndNotThatOfItsLastStep) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  constexpr unsigned joint = 2;
  HardwareOptions options;
  std::vector<double> monitored;
  options.on_frame = [&](const Transmission& transmission) {
    const auto monitoring = canopen::decode_monitoring(transmission.frame);
    if (monitoring && monitoring->node == scenario.modules[joint].node) {
      monitored.push_back(monitoring->current_ma);
    }
  };
  VirtualRobot robot(scenario, std::move(options));
  double to_mean = 0.0;
  double to_last_step = 0.0;
  for (std::uint32_t tick = 0; tick < 500; ++tick) {
    const std::size_t before = monitored.size();
    const double mean = tick > 0 ? robot.loop().plant().servo_currents()[joint] : 0.0;
    const double last = robot.loop().plant().servo_readings(joint).current_ma;
    robot.run_to(tick + 1);
    if (tick > 10 && monitored.size() > before) {
      to_mean += std::abs(monitored.back() - mean);
      to_last_step += std::abs(monitored.back() - last);
    }
  }
  ASSERT_GT(monitored.size(), 40U);
  std::cout << "mean current: off by " << to_mean << " mA in all; current of the last step: " << to_last_step << '\n';
  EXPECT_LT(to_mean, 0.3 * to_last_step);
}

TEST(VirtualModule, PrintsItsIdentityOnItsConsole) {
  VirtualRobot robot(shipped("travelling_wave/uniform"));
  for (unsigned joint = 0; joint < 5; ++joint) {
    const std::string node = "node " + std::to_string(robot.scenario().modules[joint].node);
    EXPECT_TRUE(std::ranges::any_of(robot.console, [&](const auto& line) {
      return line.first == joint && line.second.find(node) != std::string::npos &&
             line.second.find("power on") != std::string::npos;
    })) << node;
  }
}

}  // namespace
}  // namespace proleg::sim
