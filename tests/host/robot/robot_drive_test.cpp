// A host drives simulated modules over a bus: from any state, with frames that are lost, with changes in flight.

#include <gtest/gtest.h>

#include "driving_host.hpp"
#include "shipped.hpp"
#include "sim/loop/gait.hpp"

namespace proleg::test {
namespace {

using canopen::MasterState;

TEST(RobotDrive, HandsOutTheStateFramesOfEveryTickWithoutAGap) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  DrivingHost host(bus, scenario);
  ASSERT_TRUE(host.start());
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  const std::vector<std::uint8_t> no_contacts(5);
  std::uint32_t expected = 0;
  for (std::uint32_t until = 20; until <= 320; until += 20) {
    ASSERT_TRUE(host.run_to_tick(until));
    while (const auto tick = host.drive.take_tick()) {
      ASSERT_EQ(tick->tick, expected++);
      chain.advance(no_contacts);
      for (unsigned joint = 0; joint < 5; ++joint) {
        ASSERT_TRUE(tick->frames[joint][0].has_value()) << tick->tick;
        const StateFrame& gait = chain.kernel(joint).frame(joint, 0);
        EXPECT_TRUE(std::equal(gait.bytes.begin(), gait.bytes.begin() + StateFrame::payload_size,
                               tick->frames[joint][0]->bytes.begin()));
      }
    }
  }
  EXPECT_GE(expected, 301U);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_TRUE(host.drive.monitoring(joint).has_value());
  }
}

TEST(RobotDrive, EveryCommandSucceedsAlthoughOneFrameInTwentyIsLost) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  constexpr std::uint64_t runs = 4;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE(seed);
    LiveBus bus(scenario);
    bus.run_for(100'000);
    bus.lose(0.05, seed);
    DrivingHost host(bus, scenario);
    ASSERT_TRUE(host.start()) << describe(host.drive.master().problem().code);
    bus.run_for(second / 2);
    EXPECT_EQ(host.drive.master().state(), MasterState::running);
    ASSERT_TRUE(host.stop());
    bus.lose(0, 0);
    bus.run_for(second / 10);
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_FALSE(bus.robot().module(joint).pulse().has_value()) << "joint " << joint;
    }
  }
}

TEST(RobotDrive, ChangesOfTheUserTakeEffectTogetherAndSoon) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  DrivingHost host(bus, scenario);
  ASSERT_TRUE(host.start());
  ASSERT_TRUE(host.run_to_tick(100));
  std::vector<Setting> values;
  for (std::uint8_t joint = 0; joint < 5; ++joint) {
    values.push_back({0, joint, 0, false, raw(Unit::degree, 10)});
  }
  std::vector<Change> changes{{Change::soon, values}};
  ASSERT_TRUE(host.drive.master().extend_changes(bus.now(), changes));
  ASSERT_TRUE(host.run_to_tick(160));
  ASSERT_FALSE(changes.front().dropped);
  const std::uint32_t tick = changes.front().tick;
  EXPECT_GE(tick, 120U) << "twenty ticks after all modules have the values";
  EXPECT_LE(tick, 130U);
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  const std::vector<std::uint8_t> no_contacts(5);
  while (const auto frames = host.drive.take_tick()) {
    if (frames->tick == tick) {
      chain.apply({tick, values});
    }
    chain.advance(no_contacts);
    for (unsigned joint = 0; joint < 5; ++joint) {
      const firmware::TickRecord record = bus.robot().module(joint).last_tick();
      if (record.tick == frames->tick) {
        EXPECT_EQ(record.setpoint, chain.setpoints()[joint]);
      }
    }
  }
}

TEST(RobotDrive, RefusesAChangeThatIsNotPossible) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  DrivingHost host(bus, scenario);
  ASSERT_TRUE(host.start());
  ASSERT_TRUE(host.run_to_tick(50));
  const std::vector<Setting> values{{0, 9, 0, false, 0}};
  std::vector<Change> changes{{Change::soon, values}};
  EXPECT_FALSE(host.drive.master().extend_changes(bus.now(), changes)) << "there is no joint 9";
  ASSERT_TRUE(host.run_to_tick(100));
  EXPECT_EQ(host.drive.master().state(), MasterState::running);
}

TEST(RobotDrive, NamesTheMissingModuleWithinThreeSecondsAndMovesNothing) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.node = joint == 2 ? 0 : identity.node;
  };
  LiveBus bus(scenario, std::move(options));
  bus.run_for(100'000);
  DrivingHost host(bus, scenario);
  const Microseconds begin = bus.now();
  EXPECT_FALSE(host.start());
  EXPECT_LT(bus.now() - begin, 3 * second);
  EXPECT_EQ(host.drive.master().problem().code, canopen::ProblemCode::missing_module);
  EXPECT_EQ(host.drive.master().problem().node, scenario.modules[2].node);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_FALSE(bus.robot().module(joint).pulse().has_value());
  }
}

TEST(RobotDrive, NamesAModuleWithAnotherCoreWithinThreeSecondsAndMovesNothing) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.core_fingerprint += joint == 3 ? 1U : 0U;
  };
  LiveBus bus(scenario, std::move(options));
  bus.run_for(100'000);
  DrivingHost host(bus, scenario);
  const Microseconds begin = bus.now();
  EXPECT_FALSE(host.start());
  EXPECT_LT(bus.now() - begin, 3 * second);
  EXPECT_EQ(host.drive.master().problem().code, canopen::ProblemCode::wrong_fingerprint);
  EXPECT_EQ(host.drive.master().problem().joint, 3U);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_FALSE(bus.robot().module(joint).pulse().has_value());
  }
}

}  // namespace
}  // namespace proleg::test
