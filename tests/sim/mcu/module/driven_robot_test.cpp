// A host drives the image that is flashed: how the joints begin, and whether all bits of the set-points are equal.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "host/robot/robot_drive.hpp"
#include "left_alone_robot.hpp"
#include "sim/loop/gait.hpp"
#include "tests/support/from_environment.hpp"
#include "virtual_robot.hpp"

namespace proleg::test {
namespace {

using canopen::MasterState;
using Result = host::SetpointCheck::Result;

constexpr unsigned joints = 5;

sim::LiveRobotOptions virtual_modules() {
  sim::LiveRobotOptions options;
  options.make_module = [](const sim::ModuleParts& parts) -> std::unique_ptr<sim::JointModule> {
    return std::make_unique<sim::VirtualModule>(parts, sim::flashed_image(), sim::VirtualModuleOptions{});
  };
  return options;
}

class DrivenImage : public testing::Test {
 protected:
  /// Until the robot moves. Each millisecond: by how much the pulses of the joints may have changed in the last ten.
  void start_and_watch(std::int32_t largest_step) {
    constexpr Microseconds most = 10'000'000;
    constexpr std::size_t window = 10;
    std::vector<std::vector<std::int32_t>> widths(joints);
    host.drive.master().start(bus.now());
    while (bus.now() < most && !host.drive.master().tick()) {
      bus.run_for(1'000);
      for (unsigned joint = 0; joint < joints; ++joint) {
        std::vector<std::int32_t>& before = widths[joint];
        if (const auto pulse = bus.robot().module(joint).pulse()) {
          before.push_back(*pulse);
          const std::int32_t earlier = before[before.size() - 1 - std::min(before.size() - 1, window)];
          ASSERT_LE(std::abs(*pulse - earlier), largest_step) << "joint " << joint;
          moved += *pulse != earlier ? 1U : 0U;
        }
      }
    }
    ASSERT_TRUE(host.drive.master().tick().has_value()) << describe(host.drive.master().problem().code);
  }

  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus{scenario, virtual_modules()};
  DrivingHost host{bus, scenario};
  unsigned moved = 0;
};

TEST_F(DrivenImage, RampsInAndHasTheSameSetpointsToTheLastBit) {
  // 90 degrees a second: 12000 in a second, 120 in 10 ms, and a pulse that comes a little later or sooner.
  start_and_watch(120 + 30);
  EXPECT_GT(moved, 100U) << "the gait does not start where the robot lies";
  ASSERT_TRUE(host.run_to_tick(100));
  ASSERT_TRUE(host.stop());
  host::SetpointCheck check(joints);
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  const std::vector<std::uint8_t> no_contacts(joints);
  for (std::uint32_t tick = 0; tick < 400; ++tick) {
    chain.advance(no_contacts);
    check.add(chain.setpoints());
  }
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_GE(host.drive.master().checksum(joint).ticks, 100U);
    EXPECT_EQ(check.compare(joint, host.drive.master().checksum(joint)), Result::equal) << "joint " << joint;
  }
}

/// PROLEG_INSTANTS: how many instants for each direction and number of joints.
TEST(DrivenImages, AreSafeWithinOneAndAHalfSecondsWhicheverDirectionIsCut) {
  const std::uint32_t instants = from_environment("PROLEG_INSTANTS", 1);
  for (const unsigned number : {3U, 5U, 20U}) {
    const sim::Scenario robot = wave_of(number);
    for (const char* const cut : cuts) {
      SCOPED_TRACE(std::string(cut) + ", joints: " + std::to_string(number));
      for (std::uint32_t seed = 1; seed <= instants && !HasFatalFailure(); ++seed) {
        expect_safe_after(cut, robot, seed, virtual_modules());
      }
    }
  }
}

}  // namespace
}  // namespace proleg::test
