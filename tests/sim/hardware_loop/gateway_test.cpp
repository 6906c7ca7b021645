// A native module as gateway (docs/protocol.md, The gateway): what a host on its serial line sees, and what it can do.

#include <set>

#include "gateway_robot.hpp"
#include "sim/hardware_loop/hardware_options.hpp"

namespace proleg::sim {
namespace {

// 0x1000 of a module: 0x00020192 (docs/objects.md).
TEST(NativeGateway, AHostReadsObjectsOfTheGatewayAndOfAnotherModule) {
  GatewayBench bench;
  bench.open();
  EXPECT_EQ(bench.ask("t60484000100000000000\r"), "z\rt58484300100092010200\r");
  EXPECT_EQ(bench.ask("t60984000100000000000\r"), "z\rt58984300100092010200\r");
  ASSERT_EQ(bench.log.size(), 2U + 4U) << "boot-up of both, and all of it on the bus";
  EXPECT_EQ(line_of(bench.log[2].frame), "t60484000100000000000\r");
}

TEST(NativeGateway, WithoutTheRoleThereIsNoAnswerOnTheLine) {
  GatewayBench bench(GatewayBench::make_native, false);
  bench.power_on();
  EXPECT_EQ(bench.ask("\rC\rV\rO\rt60484000100000000000\r"), "");
}

TEST(NativeGateway, AClosedChannelSendsNothing) {
  GatewayBench bench;
  bench.open();
  EXPECT_EQ(bench.ask("C\r"), "\r");
  bench.modules[1]->power_on(bench.bus.now());
  bench.run_for(50 * GatewayBench::ms);
  EXPECT_EQ(bench.log.back().frame.identifier, 0x709);
  EXPECT_EQ(bench.host.take_text(), "");
}

TEST(NativeGateway, AResetOfTheNodesKeepsTheChannelOpenAndTheHostSeesTheBootUps) {
  GatewayBench bench;
  bench.open();
  const auto lines = lines_of(bench.ask("t00028100\r", 50 * GatewayBench::ms));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "z\r");
  EXPECT_EQ((std::set<std::string>{lines[1], lines[2]}), (std::set<std::string>{"t704100\r", "t709100\r"}));
}

TEST(NativeGateway, ARestartOfTheModuleClosesTheChannel) {
  GatewayBench bench;
  expect_restart_closes_channel(bench);
}

TEST(NativeGateway, TheRoleComesIntoForceWhenItWasSavedAtTheNextResetOfTheNode) {
  GatewayBench bench(GatewayBench::make_native, false);
  bench.power_on();
  Injector other(bench.bus, {});
  const auto send = [&](const CanFrame& frame) {
    other.send_now(frame);
    bench.run_for(20 * GatewayBench::ms);
  };
  send({0x604, 8, {0x2F, 0x20, 0x20, 0x01, 1}});
  send({0x000, 2, {0x81, 0x04}});
  EXPECT_EQ(bench.ask("V\r"), "") << "not saved";
  send({0x604, 8, {0x2F, 0x20, 0x20, 0x01, 1}});
  send({0x604, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  EXPECT_EQ(bench.ask("V\r"), "") << "not yet";
  send({0x000, 2, {0x81, 0x04}});
  EXPECT_EQ(bench.ask("V\r").front(), 'V');
  send({0x604, 8, {0x2F, 0x20, 0x20, 0x01, 0}});
  send({0x604, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  send({0x000, 2, {0x81, 0x04}});
  EXPECT_EQ(bench.ask("V\r"), "") << "not a gateway any more";
}

TEST(NativeGateway, BusOffAndTheWayBackAreLinesForTheHost) {
  GatewayBench bench;
  expect_lines_of_bus_states(bench);
}

TEST(NativeGateway, EveryFrameOfAMinuteOfGaitIsOnTheLine) { expect_every_frame_on_the_line({}, 6'000); }

TEST(NativeGateway, AFloodInBothDirectionsChangesNoSetPoint) { expect_flood_changes_nothing({}, 1'000); }

TEST(NativeGateway, NoiseOnTheLineChangesNoSetPoint) { expect_noise_changes_nothing({}, 500); }

}  // namespace
}  // namespace proleg::sim
