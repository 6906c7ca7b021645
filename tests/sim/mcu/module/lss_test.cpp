// Factory-fresh chips with the flashed image get node ids by LSS (CiA 305) and keep them in their flash.

#include <set>

#include "lss_robot.hpp"
#include "sim/hardware_loop/native_module.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

TEST(LssRobot, FlashedChipsWithoutNodeIdsGetThemBesideANativeModuleThatHasOne) {
  constexpr unsigned count = 4;
  LssRobot robot;
  std::vector<std::string> console;
  for (unsigned i = 0; i < count; ++i) {
    const auto readings = [] { return ServoReadings{}; };
    ModuleParts parts{
        robot.bus, i,       {}, Crystal(static_cast<std::int32_t>(i) * 50'000 - 75'000), [] { return std::uint8_t{0}; },
        readings,  readings};
    parts.identity.unique_id = {0x1234'5678U * (i + 1), i, 0xFEDC'BA98U};
    VirtualModuleOptions options;
    options.console = [&console](const std::string& line) { console.push_back(line); };
    robot.modules.push_back(std::make_unique<VirtualModule>(parts, flashed_image(), std::move(options)));
  }
  firmware::ModuleIdentity configured;
  configured.node = 7;
  robot.modules.push_back(
      std::make_unique<NativeModule>(robot.bus, configured, Crystal(0), [] { return std::uint8_t{0}; }));
  robot.power_on();
  EXPECT_EQ(robot.log.size(), 1U) << "boot-up of the configured module";
  ASSERT_EQ(console.size(), count);
  EXPECT_NE(console[0].find("no node id, waits for LSS"), std::string::npos) << console[0];

  std::vector<canopen::LssModule> entries;
  for (unsigned i = 0; i < count; ++i) {
    entries.push_back({static_cast<std::uint8_t>(20 + i)});
  }
  robot.assign(entries, 10'000 * LssRobot::ms);
  EXPECT_EQ(robot.master->state(), canopen::LssMaster::State::done) << describe(robot.master->problem());
  EXPECT_EQ(robot.master->assigned(), count);
  std::cout << count << " chips: " << static_cast<double>(robot.duration) * 1e-9 << " s, " << robot.log.size()
            << " frames\n";

  const std::size_t before = robot.log.size();
  console.clear();
  robot.power_on();
  for (const canopen::LssModule& entry : entries) {
    EXPECT_EQ(robot.count(static_cast<std::uint16_t>(canopen::identifier::heartbeat + entry.node), before), 1U);
  }
  ASSERT_EQ(console.size(), count);
  EXPECT_NE(console[0].find("proleg module, node 2"), std::string::npos) << console[0];
  for (const auto& module : robot.modules) {
    EXPECT_EQ(module->take_problem(), std::nullopt);
  }
}

}  // namespace
}  // namespace proleg::sim
