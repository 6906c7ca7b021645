// A robot whose modules come from the factory: all get node ids by LSS (CiA 305) and keep them.

#include <random>
#include <set>

#include "lss_robot.hpp"
#include "sim/hardware_loop/native_module.hpp"

namespace proleg::sim {
namespace {

TEST(LssRobot, TwentyNativeModulesWithoutNodeIdsGetThemAndKeepThemOverARestart) {
  constexpr unsigned count = 20;
  constexpr unsigned seed = 20;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  LssRobot robot;
  for (unsigned i = 0; i < count; ++i) {
    firmware::ModuleIdentity identity;
    identity.unique_id = {static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()),
                          static_cast<std::uint32_t>(random())};
    const Crystal crystal(static_cast<std::int32_t>(random() % 200'000) - 100'000);
    robot.modules.push_back(
        std::make_unique<NativeModule>(robot.bus, identity, crystal, [] { return std::uint8_t{0}; }));
  }
  robot.power_on();
  EXPECT_TRUE(robot.log.empty());
  std::vector<canopen::LssModule> entries;
  for (unsigned i = 0; i < count; ++i) {
    entries.push_back({static_cast<std::uint8_t>(10 + i)});
  }
  robot.assign(entries, 30'000 * LssRobot::ms);
  EXPECT_EQ(robot.master->state(), canopen::LssMaster::State::done) << describe(robot.master->problem());
  EXPECT_EQ(robot.master->assigned(), count);
  std::set<unsigned> nodes;
  for (const auto& module : robot.modules) {
    nodes.insert(dynamic_cast<NativeModule&>(*module).node());
  }
  EXPECT_EQ(nodes.size(), count);
  EXPECT_EQ(*nodes.begin(), 10U);
  EXPECT_EQ(*nodes.rbegin(), 10U + count - 1);
  EXPECT_EQ(robot.bus.statistics().errors, 0U);
  std::cout << count << " modules: " << static_cast<double>(robot.duration) * 1e-9 << " s, " << robot.log.size()
            << " frames\n";

  const std::size_t before = robot.log.size();
  robot.power_on();
  for (const canopen::LssModule& entry : entries) {
    EXPECT_EQ(robot.count(static_cast<std::uint16_t>(canopen::identifier::heartbeat + entry.node), before), 1U);
  }
  // The next master finds none without a node id.
  robot.assign(entries, 1'000 * LssRobot::ms);
  EXPECT_EQ(robot.master->state(), canopen::LssMaster::State::done);
  EXPECT_EQ(robot.master->assigned(), 0U);
}

}  // namespace
}  // namespace proleg::sim
