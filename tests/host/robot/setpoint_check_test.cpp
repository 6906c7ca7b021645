// All bits of the set-points: what the modules of a driven robot have computed, against kernels in this process.

#include "host/robot/robot_drive.hpp"

#include <gtest/gtest.h>

#include "driving_host.hpp"
#include "shipped.hpp"
#include "sim/loop/gait.hpp"

namespace proleg::test {
namespace {

using canopen::MasterState;
using host::SetpointCheck;
using Result = SetpointCheck::Result;
using ChecksumState = canopen::Master::SetpointChecksum::State;

/// A run of some ticks, and then the stop, in which the master reads the checksums.
class DrivenRobot {
 public:
  explicit DrivenRobot(sim::LiveRobotOptions options = {})
      : scenario(sim::shipped("travelling_wave/uniform")), bus(scenario, std::move(options)), host(bus, scenario) {}

  void run(const std::function<void()>& in_the_middle = {}) {
    ASSERT_TRUE(host.start());
    ASSERT_TRUE(host.run_to_tick(150));
    if (in_the_middle) {
      in_the_middle();
    }
    ASSERT_TRUE(host.run_to_tick(300));
    ASSERT_TRUE(host.stop());
  }
  [[nodiscard]] canopen::Master::SetpointChecksum found(unsigned joint) { return host.drive.master().checksum(joint); }

  sim::Scenario scenario;
  LiveBus bus;
  DrivingHost host;
};

/// The kernels of this process. change: is added to one set-point of joint 3.
SetpointCheck expected(const sim::Scenario& scenario, std::int32_t change = 0) {
  SetpointCheck check(5);
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  const std::vector<std::uint8_t> no_contacts(5);
  for (std::uint32_t tick = 0; tick < 600; ++tick) {
    chain.advance(no_contacts);
    std::vector<std::int32_t> setpoints(chain.setpoints().begin(), chain.setpoints().end());
    setpoints[3] += tick == 40 ? change : 0;
    check.add(setpoints);
  }
  return check;
}

TEST(SetpointCheckOfADrive, EveryBitOfEverySetpointIsEqual) {
  DrivenRobot drive;
  drive.run();
  const SetpointCheck check = expected(drive.scenario);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(drive.found(joint).state, ChecksumState::read);
    EXPECT_GE(drive.found(joint).ticks, 300U);
    EXPECT_EQ(check.compare(joint, drive.found(joint)), Result::equal) << "joint " << joint;
  }
}

TEST(SetpointCheckOfADrive, SeesTheLowestBitOfOneSetpoint) {
  DrivenRobot drive;
  drive.run();
  const SetpointCheck check = expected(drive.scenario, 1);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(check.compare(joint, drive.found(joint)), joint == 3 ? Result::different : Result::equal);
  }
}

TEST(SetpointCheckOfADrive, SaysThatAModuleHasJoinedLate) {
  DrivenRobot drive;
  drive.run([&drive] {
    const canopen::NmtRequest reset{canopen::NmtCommand::reset_node, drive.scenario.modules[2].node};
    ASSERT_TRUE(drive.bus.send(encode(reset)));
    drive.bus.run_for(second);
  });
  EXPECT_EQ(drive.host.drive.master().restarts(), 1U);
  const SetpointCheck check = expected(drive.scenario);
  EXPECT_EQ(check.compare(2, drive.found(2)), Result::not_complete);
  EXPECT_EQ(check.compare(1, drive.found(1)), Result::equal) << "the plain sine does not read its neighbours";
}

TEST(SetpointCheckOfADrive, AModuleThatDoesNotAnswerIsNotCompared) {
  DrivenRobot drive;
  ASSERT_TRUE(drive.host.start());
  ASSERT_TRUE(drive.host.run_to_tick(100));
  drive.bus.robot().bus().controller(drive.bus.robot().module(4).controller()).unplug();
  drive.bus.run_for(second / 10);
  ASSERT_TRUE(drive.host.stop());
  const SetpointCheck check = expected(drive.scenario);
  EXPECT_EQ(check.compare(4, drive.found(4)), Result::no_answer);
  EXPECT_EQ(check.compare(0, drive.found(0)), Result::equal);
}

TEST(SetpointCheck, KnowsTheLastTicksOnly) {
  SetpointCheck check(1);
  const std::vector<std::int32_t> zero{0};
  std::vector<std::uint32_t> crcs{0};
  Crc32 crc;
  for (std::uint32_t tick = 0; tick < SetpointCheck::kept_ticks + 10; ++tick) {
    check.add(zero);
    crc.add_little_endian(0, 4);
    crcs.push_back(crc.value());
  }
  const auto result = [&](std::uint32_t ticks) {
    return check.compare(0, {ChecksumState::read, ticks, ticks < crcs.size() ? crcs[ticks] : 0});
  };
  EXPECT_EQ(result(SetpointCheck::kept_ticks + 10), Result::equal);
  EXPECT_EQ(result(11), Result::equal);
  EXPECT_EQ(result(10), Result::unknown_tick);
  EXPECT_EQ(result(SetpointCheck::kept_ticks + 11), Result::unknown_tick);
  EXPECT_EQ(check.compare(0, {ChecksumState::not_available, 0, 0}), Result::no_checksum);
}

}  // namespace
}  // namespace proleg::test
