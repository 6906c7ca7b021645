// Who is on the bus: every module with what it says of itself, also when frames are lost, and nothing is changed.

#include "host/robot/bus_scan.hpp"

#include <gtest/gtest.h>

#include <deque>

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

TEST(BusScan, MissesNoNodeOnABusThatLosesATwentiethOfTheFrames) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  bus.lose(0.05, 1);
  for (unsigned i = 0; i < 20; ++i) {
    BusScan scan(bus);
    ASSERT_TRUE(finish(bus, scan, 20 * second));
    EXPECT_EQ(scan.nodes().size(), 5U) << i;
  }
}

/// Hands the first answers of a node out late, as a busy computer does.
class LateAtFirst final : public host::BusUser {
 public:
  static constexpr Microseconds delay_us = 300'000;

  LateAtFirst(host::BusUser& user, std::uint32_t identifier, unsigned answers)
      : user_(user), identifier_(identifier), answers_(answers) {}
  void receive(Microseconds now, const CanFrame& frame) override {
    if (frame.identifier == identifier_ && answers_ > 0) {
      --answers_;
      late_.push_back({now + delay_us, frame});
    } else {
      user_.receive(now, frame);
    }
  }
  void transmitted(Microseconds now, const CanFrame& frame) override { user_.transmitted(now, frame); }
  void poll(Microseconds now) override {
    while (!late_.empty() && late_.front().time <= now) {
      const CanFrame frame = late_.front().frame;
      late_.pop_front();
      user_.receive(now, frame);
    }
    user_.poll(now);
  }
  [[nodiscard]] Microseconds next_deadline() const override {
    return late_.empty() ? user_.next_deadline() : std::min(user_.next_deadline(), late_.front().time);
  }

 private:
  struct Late {
    Microseconds time;
    CanFrame frame;
  };

  host::BusUser& user_;
  std::uint32_t identifier_;
  unsigned answers_;
  std::deque<Late> late_;
};

TEST(BusScan, AsksANodeAgainWhoseAnswersCameTooLate) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  BusScan scan(bus);
  LateAtFirst late(scan, 0x583, 2);
  bus.attach(late);
  scan.start(bus.now());
  ASSERT_TRUE(bus.run_until(bus.now() + 5 * second, [&scan] { return scan.is_done(); }));
  bus.detach(late);
  const std::vector<ScannedNode> nodes = scan.nodes();
  ASSERT_EQ(nodes.size(), 5U);
  for (const ScannedNode& node : nodes) {
    EXPECT_TRUE(node.is_module) << "node " << unsigned{node.node};
    EXPECT_EQ(node.name, "Proleg joint module");
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

TEST(BusScan, SaysThatAModuleHasNoNodeIdAlthoughATenthOfTheFramesIsLost) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    sim::LiveRobotOptions options;
    options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
      identity.node = joint < 1 ? 0 : identity.node;
    };
    LiveBus bus(scenario, std::move(options));
    bus.run_for(100'000);
    bus.lose(0.1, seed);
    BusScan scan(bus);
    ASSERT_TRUE(finish(bus, scan, 20 * second));
    EXPECT_TRUE(scan.has_fresh_modules());
  }
}

}  // namespace
}  // namespace proleg::test
