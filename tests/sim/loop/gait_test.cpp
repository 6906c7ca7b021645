#include "sim/loop/gait.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "shipped.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

const std::vector<std::uint8_t> no_contacts(5);

Scenario with_changes() {
  Scenario scenario = shipped("travelling_wave/coupled");
  apply_setting(scenario, "amplitude=12@15");
  apply_setting(scenario, "amplitude=33@25");
  return scenario;
}

/// The set-points of all ticks up to 60.
std::vector<std::int32_t> setpoints_of(const Scenario& scenario) {
  Gait gait(scenario);
  std::vector<std::int32_t> setpoints;
  while (gait.tick() < 60) {
    gait.apply_due_changes();
    gait.advance(no_contacts);
    setpoints.insert(setpoints.end(), gait.chain().setpoints().begin(), gait.chain().setpoints().end());
  }
  return setpoints;
}

TEST(Gait, TakesEachChangeAtItsTick) {
  const Scenario scenario = with_changes();
  Gait gait(scenario);
  KernelChain expected(scenario.kernel, scenario.joint_limits, scenario.settings);
  for (std::uint32_t tick = 0; tick < 60; ++tick) {
    const Change* change = nullptr;
    if (tick == 15 || tick == 25) {
      change = &scenario.changes[tick == 15 ? 0 : 1];
      expected.apply(*change);
    }
    EXPECT_EQ(gait.due_change().has_value(), change != nullptr) << tick;
    EXPECT_EQ(gait.apply_due_changes(), change) << tick;
    gait.advance(no_contacts);
    expected.advance(no_contacts);
    ASSERT_TRUE(std::ranges::equal(gait.chain().setpoints(), expected.setpoints())) << tick;
  }
}

TEST(Gait, TakesAllChangesOfATick) {
  Scenario scenario = with_changes();
  scenario.changes[1].tick = 15;
  Scenario only_last = scenario;
  only_last.changes.erase(only_last.changes.begin());
  EXPECT_EQ(setpoints_of(scenario), setpoints_of(only_last)) << "both change the same parameter";
  Gait gait(scenario);
  while (gait.tick() < 15) {
    gait.advance(no_contacts);
  }
  EXPECT_EQ(gait.apply_due_changes(), &scenario.changes[1]) << "the last of them";
  EXPECT_EQ(gait.next_change(), 2U);
}

TEST(Gait, WithoutAChangeThatIsLeftOutIsThatOfTheOthers) {
  const Scenario scenario = with_changes();
  Scenario without = scenario;
  without.changes.erase(without.changes.begin());
  Gait gait(scenario);
  std::vector<std::int32_t> setpoints;
  while (gait.tick() < 60) {
    if (gait.due_change() == 0U) {
      gait.leave_out_change();
    }
    gait.apply_due_changes();
    gait.advance(no_contacts);
    setpoints.insert(setpoints.end(), gait.chain().setpoints().begin(), gait.chain().setpoints().end());
  }
  EXPECT_EQ(setpoints, setpoints_of(without));
  EXPECT_NE(setpoints, setpoints_of(scenario));
}

TEST(Gait, TakesChangesThatAreAddedWhileItRuns) {
  Scenario scenario = with_changes();
  const std::vector<std::int32_t> expected = setpoints_of(scenario);
  const std::vector<Change> later = std::exchange(scenario.changes, {});
  Gait gait(scenario);
  std::vector<std::int32_t> setpoints;
  while (gait.tick() < 60) {
    if (gait.tick() == 15 || gait.tick() == 20) {
      scenario.changes.push_back(later[gait.tick() == 15 ? 0 : 1]);
    }
    gait.apply_due_changes();
    gait.advance(no_contacts);
    setpoints.insert(setpoints.end(), gait.chain().setpoints().begin(), gait.chain().setpoints().end());
  }
  EXPECT_EQ(setpoints, expected);
}

TEST(Gait, GivesARecorderWhatItComputedInTheLastTick) {
  Scenario scenario = shipped("travelling_wave/coupled");
  scenario.robot.servo.period_us = 2'500;  // four intervals in a tick
  Gait gait(scenario);
  while (gait.tick() < 8) {
    gait.advance(no_contacts);
  }
  const TickSample sample = gait.sample();
  EXPECT_EQ(sample.tick, 7U);
  EXPECT_TRUE(std::ranges::equal(sample.setpoints, gait.chain().setpoints()));
  ASSERT_EQ(sample.servo_pulses.size(), 20U);
  EXPECT_EQ(sample.servo_pulses.front().time_us, 70'000U);
  EXPECT_EQ(sample.servo_pulses.back().time_us, 77'500U);
  EXPECT_EQ(sample.servo_pulses.back().joint, 4U);
  ASSERT_FALSE(sample.internal_values.empty());
  EXPECT_EQ(sample.internal_values.front(), gait.chain().kernel(0).internal_value(0, 0, 0));
  EXPECT_TRUE(sample.link_poses.empty()) << "the gait has no world";
}

}  // namespace
}  // namespace proleg::sim
