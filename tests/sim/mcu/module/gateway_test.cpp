// The flashed image as gateway: the same characters on its serial line as those of a native module, from registers,
// interrupts and DMA of USART2.

#include <algorithm>

#include "gateway_robot.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

std::unique_ptr<JointModule> make_virtual(const ModuleParts& parts) {
  return std::make_unique<VirtualModule>(parts, flashed_image(), VirtualModuleOptions{});
}

TEST(VirtualGateway, AHostReadsObjectsOfTheGatewayAndOfAnotherModule) {
  GatewayBench bench(make_virtual);
  bench.open();
  EXPECT_EQ(bench.ask("t60484000100000000000\r"), "z\rt58484300100092010200\r");
  EXPECT_EQ(bench.ask("t60984000100000000000\r"), "z\rt58984300100092010200\r");
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, PrintsItsStartAtTheBaudRateOfTheLineBeforeTheChannelCanBeOpened) {
  GatewayBench bench(make_virtual);
  bench.host.sender.send(0, "\r\r\rO\r");  // while the chip starts: lost
  bench.power_on();
  const std::string text = bench.host.take_text();
  EXPECT_TRUE(text.starts_with("proleg module, node 4, board 1, core ")) << text;
  EXPECT_TRUE(text.ends_with("started by power on\r\n")) << text;
  EXPECT_EQ(bench.ask("V\r"), "V1010\r");
}

TEST(VirtualGateway, WithoutTheRoleTheConsoleHasItsOwnBaudRateAndTheLineNoAnswer) {
  GatewayBench bench(make_virtual, false);
  bench.power_on();
  EXPECT_TRUE(bench.host.take_text().starts_with("proleg module, node 4"));
  EXPECT_EQ(bench.ask("\rC\rV\rO\rt60484000100000000000\r"), "");
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, TheRoleComesIntoForceAtTheNextResetOfTheNodeEvenWhileTheConsoleSends) {
  GatewayBench bench(make_virtual, false);
  bench.power_on();
  Injector other(bench.bus, {});
  const auto send = [&](const CanFrame& frame) {
    other.send_now(frame);
    bench.run_for(20 * GatewayBench::ms);
  };
  send({0x604, 8, {0x2F, 0x20, 0x20, 0x01, 1}});
  send({0x604, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  EXPECT_EQ(bench.ask("V\r"), "");
  send({0x000, 2, {0x81, 0x04}});
  EXPECT_EQ(bench.ask("V\r", 100 * GatewayBench::ms), "V1010\r");
  send({0x604, 8, {0x2F, 0x20, 0x20, 0x01, 0}});
  send({0x604, 8, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  send({0x000, 2, {0x81, 0x04}});
  bench.run_for(100 * GatewayBench::ms);
  EXPECT_EQ(bench.ask("V\r"), "");
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, AConversationHasTheSameCharactersAsWithANativeModule) {
  GatewayBench native;
  GatewayBench flashed(make_virtual);
  const std::string expected = hold_conversation(native);
  EXPECT_EQ(hold_conversation(flashed), expected);
  EXPECT_EQ(flashed.gateway().take_problem(), std::nullopt);
  // Both modules boot at once: microseconds decide which boot-up is the first.
  const auto lines_of = [](const GatewayBench& bench) {
    std::vector<std::string> lines;
    lines.reserve(bench.log.size());
    for (const auto& logged : bench.log) {
      lines.push_back(line_of(logged.frame));
    }
    std::sort(lines.begin(), lines.begin() + 2);
    return lines;
  };
  ASSERT_GE(native.log.size(), 2U);
  ASSERT_GE(flashed.log.size(), 2U);
  EXPECT_EQ(lines_of(native), lines_of(flashed));
  std::cout << expected.size() << " characters, " << native.log.size() << " frames\n";
}

TEST(VirtualGateway, BusOffAndTheWayBackAreLinesForTheHost) {
  GatewayBench bench(make_virtual);
  expect_lines_of_bus_states(bench);
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, ARestartOfTheModuleClosesTheChannel) {
  GatewayBench bench(make_virtual);
  expect_restart_closes_channel(bench);
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, ABurstOfTwoThousandFramesReachesTheBus) {
  GatewayBench bench(make_virtual);
  bench.open();
  const std::size_t before = bench.log.size();
  std::string burst;
  for (unsigned i = 0; i < 2'000; ++i) {
    burst += line_of({0x6E0, 8, {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8U), 3, 4, 5, 6, 7, 8}});
  }
  const std::string answers = bench.ask(burst, 600 * GatewayBench::ms);
  ASSERT_EQ(bench.log.size(), before + 2'000);
  for (unsigned i = 0; i < 2'000; ++i) {
    const CanFrame& frame = bench.log[before + i].frame;
    EXPECT_EQ(frame.data[0] + 256U * frame.data[1], i);
  }
  EXPECT_EQ(answers.find('\a'), std::string::npos);
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

TEST(VirtualGateway, LinesThatComeWhileTheFlashIsErasedAreRejectedAndTheNextOnesAreNot) {
  GatewayBench bench(make_virtual);
  bench.open();
  // Every write of the settings appends a record; the 512th erases the sector (docs/board.md).
  static_cast<void>(bench.ask("t00028004\r"));
  for (unsigned i = 0; i < 520; ++i) {
    const std::string line = i % 2 == 0 ? "t60482B0A200164000000\r" : "t60482B0A200165000000\r";
    bench.write(line);
    bench.write(
        "t604823101001736176"
        "65\r");
    bench.run_for(4 * GatewayBench::ms);
    bench.write("t60484000100000000000\r");
    bench.run_for(4 * GatewayBench::ms);
  }
  bench.run_for(600 * GatewayBench::ms);
  static_cast<void>(bench.ask("\r"));  // the end of a line that was cut
  const std::string wrong_lines = bench.ask(
      "t604840"
      "0C200300000000\r");
  ASSERT_TRUE(wrong_lines.starts_with("z\rt5848430C2003")) << wrong_lines;
  EXPECT_NE(wrong_lines, "z\rt5848430C200300000000\r") << "some have come while the flash was erased";
  EXPECT_EQ(bench.ask("t60484000100000000000\r"), "z\rt58484300100092010200\r");
  EXPECT_EQ(bench.gateway().take_problem(), std::nullopt);
}

/// All five are virtual chips: the gateway alone costs more.
TEST(VirtualGateway, EveryFrameOfTheGaitIsOnTheLine) { expect_every_frame_on_the_line(make_virtual, 500); }

TEST(VirtualGateway, AFloodInBothDirectionsChangesNoSetPoint) {
  std::uint64_t worst = 0;
  std::uint64_t busiest = 0;
  const auto make = [&](const ModuleParts& parts) {
    VirtualModuleOptions options;
    if (parts.is_gateway) {
      options.on_tick = [&](const TickCost& cost) {
        worst = std::max(worst, cost.to_state_frame);
        busiest = std::max(busiest, cost.whole);
      };
    }
    return std::make_unique<VirtualModule>(parts, flashed_image(), std::move(options));
  };
  expect_flood_changes_nothing(make, 300);
  EXPECT_GT(worst, 0U);
  EXPECT_LT(worst, 20'000U) << "instructions from SYNC to the state frame (docs/architecture.md)";
  std::cout << worst << " instructions from SYNC to the state frame, " << busiest << " in a tick, at worst\n";
}

TEST(VirtualGateway, NoiseOnTheLineChangesNoSetPoint) { expect_noise_changes_nothing(make_virtual, 200); }

}  // namespace
}  // namespace proleg::sim
