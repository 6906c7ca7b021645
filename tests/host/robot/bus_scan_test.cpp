// Who is on the bus: every module with what it says of itself, also when frames are lost, and nothing is changed.

#include "host/robot/bus_scan.hpp"

#include <gtest/gtest.h>

#include "live_bus.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "shipped.hpp"

namespace proleg::test {
namespace {

using host::BusScan;
using host::ScannedNode;

bool finish(LiveBus& bus, BusScan& scan, Microseconds at_most = 5 * second) {
  bus.attach(scan);
  scan.start(bus.now());
  const bool is_done = bus.run_until(bus.now() + at_most, [&scan] { return scan.is_done(); });
  bus.detach(scan);
  return is_done;
}

TEST(BusScan, FindsEveryModuleAndReadsWhoItIs) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  BusScan scan(bus);
  const Microseconds begin = bus.now();
  ASSERT_TRUE(finish(bus, scan));
  EXPECT_LT(bus.now() - begin, second);
  const std::vector<ScannedNode> nodes = scan.nodes();
  ASSERT_EQ(nodes.size(), 5U);
  for (const ScannedNode& node : nodes) {
    EXPECT_TRUE(node.has_answered);
    EXPECT_TRUE(node.is_module);
    EXPECT_EQ(node.device_type, 0x20192U);
    EXPECT_EQ(node.vendor, 0x50524F4CU);
    EXPECT_NE(node.serial, 0U);
    EXPECT_EQ(node.protocol, 0x100U);
    EXPECT_EQ(node.core_fingerprint, core_fingerprint);
    EXPECT_FALSE(node.joint.has_value()) << "no host has configured it";
    EXPECT_EQ(node.name, "Proleg joint module");
    EXPECT_EQ(node.hardware, "board 1");
    EXPECT_EQ(node.error_register, 0U);
  }
  EXPECT_FALSE(scan.has_host());
  EXPECT_FALSE(scan.has_fresh_modules());
  EXPECT_TRUE(scan.duplicates().empty());
}

TEST(BusScan, FindsAllOfThemAlthoughATenthOfTheFramesIsLost) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    LiveBus bus(scenario);
    bus.run_for(100'000);
    bus.lose(0.1, seed);
    BusScan scan(bus, {.attempts = 6, .further_attempts = 20});
    ASSERT_TRUE(finish(bus, scan, 20 * second));
    const std::vector<ScannedNode> nodes = scan.nodes();
    ASSERT_EQ(nodes.size(), 5U);
    for (const ScannedNode& node : nodes) {
      EXPECT_EQ(node.name, "Proleg joint module");
      EXPECT_EQ(node.core_fingerprint, core_fingerprint);
    }
  }
}

TEST(BusScan, SaysThatModulesHaveNoNodeId) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.node = joint < 2 ? 0 : identity.node;
  };
  LiveBus bus(scenario, std::move(options));
  bus.run_for(100'000);
  BusScan scan(bus);
  ASSERT_TRUE(finish(bus, scan));
  EXPECT_EQ(scan.nodes().size(), 3U);
  EXPECT_TRUE(scan.has_fresh_modules());
}

}  // namespace
}  // namespace proleg::test
