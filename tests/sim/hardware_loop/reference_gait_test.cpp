#include "sim/hardware_loop/reference_gait.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "shipped.hpp"
#include "sim/loop/gait.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

class Reference : public testing::Test {
 protected:
  static constexpr unsigned joint = 2;
  static constexpr ReferenceGait::ModuleTick computed{true, true, false};
  static constexpr ReferenceGait::ModuleTick silent{false, false, false};
  static constexpr ReferenceGait::ModuleTick failed_after_sending{false, true, false};
  static constexpr ReferenceGait::ModuleTick restarted{false, false, true};

  /// A tick in which the module of one joint did this and all others computed.
  void advance(const ReferenceGait::ModuleTick& module) {
    report.restart_events.clear();
    for (unsigned other = 0; other < 5; ++other) {
      gait.follow(other, other == joint ? module : computed, report);
    }
    gait.advance(std::vector<std::uint8_t>(6), false);
  }

  Scenario scenario = shipped("travelling_wave/coupled");
  ReferenceGait gait{scenario, nullptr};
  HardwareReport report;
};

TEST_F(Reference, RunsAllJointsWhileTheirModulesCompute) {
  advance(computed);
  EXPECT_TRUE(gait.chain().is_running(joint));
  EXPECT_TRUE(report.restart_events.empty());
  EXPECT_EQ(report.differences, 0U);
}

TEST_F(Reference, StopsAndJoinsAJointWithItsModuleWithoutAFailureIfTheRunRestartedIt) {
  advance(computed);
  advance(restarted);
  EXPECT_FALSE(gait.chain().is_running(joint));
  ASSERT_EQ(report.restart_events.size(), 1U);
  EXPECT_EQ(report.restart_events[0].joint, joint);
  EXPECT_FALSE(report.restart_events[0].joined);
  advance(silent);
  EXPECT_TRUE(report.restart_events.empty());
  advance(computed);
  EXPECT_TRUE(gait.chain().is_running(joint));
  ASSERT_EQ(report.restart_events.size(), 1U);
  EXPECT_TRUE(report.restart_events[0].joined);
  EXPECT_TRUE(report.failures.empty());
  EXPECT_EQ(report.differences, 0U);
}

TEST_F(Reference, ReportsAModuleThatMissesATickAsFailedUntilItJoins) {
  advance(computed);
  advance(silent);
  ASSERT_EQ(report.failures.size(), 1U);
  EXPECT_EQ(report.failures[0].tick, 1U);
  EXPECT_EQ(report.failures[0].joint, joint);
  ASSERT_TRUE(report.first_difference);
  EXPECT_EQ(report.first_difference->kind, Difference::Kind::missed_tick);
  EXPECT_TRUE(gait.has_failed(joint));
  EXPECT_FALSE(gait.stands_in_for(joint));
  EXPECT_FALSE(gait.chain().is_running(joint));
  advance(computed);
  EXPECT_FALSE(gait.has_failed(joint));
  EXPECT_EQ(report.failures.size(), 1U);
}

TEST_F(Reference, StandsInForAModuleThatFailsAfterItHasSentItsState) {
  advance(computed);
  advance(failed_after_sending);
  EXPECT_EQ(report.failures.size(), 1U);
  EXPECT_TRUE(gait.stands_in_for(joint));
  EXPECT_TRUE(report.restart_events.empty());
  advance(silent);
  EXPECT_FALSE(gait.stands_in_for(joint));
  EXPECT_FALSE(gait.chain().is_running(joint));
  EXPECT_EQ(report.failures.size(), 1U) << "one failure is reported once";
}

TEST_F(Reference, ComparesSetpointsAndPulsesAndLeavesOutThoseOfFailedModules) {
  ServoPulses source({scenario.robot.servo.period_us, scenario.kernel.tick_period_us}, scenario.joint_limits,
                     scenario.robot.servo.command_speed);
  advance(computed);
  std::vector<std::int32_t> setpoints(gait.chain().setpoints().begin(), gait.chain().setpoints().end());
  std::vector<ServoPulse> pulses;
  source.append(gait.chain(), pulses);
  gait.compare(setpoints, pulses, report);
  EXPECT_EQ(report.differences, 0U);
  ++setpoints[1];
  pulses.pop_back();
  gait.compare(setpoints, pulses, report);
  EXPECT_EQ(report.differences, 2U);
  EXPECT_EQ(report.differences_of[1], 1U);
  EXPECT_EQ(report.differences_of[4], 1U);
  EXPECT_EQ(report.first_difference->joint, 1U);

  advance(failed_after_sending);
  setpoints.assign(gait.chain().setpoints().begin(), gait.chain().setpoints().end());
  pulses.clear();
  source.append(gait.chain(), pulses);
  std::erase_if(pulses, [](const ServoPulse& pulse) { return pulse.joint == joint; });
  const std::uint64_t before = report.differences;
  gait.compare(setpoints, pulses, report);
  EXPECT_EQ(report.differences, before);
}

TEST_F(Reference, AppliesChangesAtTheirTicks) {
  apply_setting(scenario, "amplitude=20@1");
  ReferenceGait changed(scenario, nullptr);
  const std::vector<std::uint8_t> no_contacts(6);
  EXPECT_FALSE(changed.due_change());
  EXPECT_EQ(changed.advance(no_contacts, false), nullptr);
  EXPECT_EQ(changed.due_change(), std::size_t{0});
  EXPECT_EQ(changed.advance(no_contacts, true), scenario.changes.data());
  EXPECT_FALSE(changed.due_change());
  EXPECT_EQ(changed.advance(no_contacts, false), nullptr);
}

TEST_F(Reference, OmitsAChangeThatTheModulesDoNotHave) {
  apply_setting(scenario, "amplitude=20@1");
  const Scenario unchanged = shipped("travelling_wave/coupled");
  ReferenceGait without(scenario, nullptr);
  ReferenceGait expected(unchanged, nullptr);
  const std::vector<std::uint8_t> no_contacts(6);
  for (int tick = 0; tick < 50; ++tick) {
    EXPECT_EQ(without.advance(no_contacts, false), nullptr);
    EXPECT_EQ(expected.advance(no_contacts, false), nullptr);
    EXPECT_TRUE(std::ranges::equal(without.chain().setpoints(), expected.chain().setpoints())) << tick;
  }
}

}  // namespace
}  // namespace proleg::sim
