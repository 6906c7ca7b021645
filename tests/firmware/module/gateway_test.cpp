// The gateway and its ports (docs/protocol.md, The gateway): which frames wait, and which are dropped.

#include "firmware/module/gateway.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/module/module.hpp"
#include "flash_memory.hpp"
#include "module_node.hpp"

namespace proleg {
namespace {

constexpr std::uint8_t gateway_node = 4;

struct Surroundings final : CanPort, firmware::ServoPort, firmware::ContactPort, firmware::LinePort {
  bool send(const CanFrame& frame) override {
    const bool is_twice =
        std::ranges::any_of(pending, [&](const CanFrame& other) { return other.identifier == frame.identifier; });
    if (is_full || is_twice || pending.size() == 3) {
      return false;
    }
    pending.push_back(frame);
    return true;
  }
  void receive_all(bool all) override { receives_all = all; }
  CanStatus status() override { return state; }
  CanErrors take_errors() override { return std::exchange(errors, {}); }
  void pulse(std::int32_t /*width*/, std::uint32_t /*period_us*/) override {}
  void off() override {}
  std::uint8_t read_contacts() override { return 0; }
  void connect(bool is_gateway) override { is_connected = is_gateway; }
  std::size_t read_line(std::span<char> characters) override {
    std::size_t count = 0;
    for (; count < characters.size() && !input.empty(); ++count) {
      characters[count] = input.front();
      input.pop_front();
    }
    return count;
  }
  bool take_damage() override { return std::exchange(is_damaged, false); }
  std::span<char> line_room() override { return has_room ? std::span<char>(buffer) : std::span<char>(); }
  void send_line(std::size_t count) override { output.append(buffer.data(), count); }

  std::vector<CanFrame> pending;  ///< frames in the mailboxes
  bool is_full = false;           ///< no mailbox is free
  bool receives_all = false;
  CanStatus state;
  CanErrors errors;
  bool is_connected = false;
  std::deque<char> input;
  std::string output;
  bool is_damaged = false;
  bool has_room = true;
  std::array<char, 100> buffer{};
};

class GatewayTest : public testing::Test {
 protected:
  GatewayTest() {
    firmware::BoardRecord board;
    board.node = gateway_node;
    board.is_gateway = true;
    EXPECT_EQ(firmware::append(flash, board), firmware::AppendResult::ok);
    module.power_on(now);
    wait(20'000);
    confirm();  // the boot-up message is sent
  }

  void wait(Microseconds time) {
    for (const Microseconds end = now + time; now < end; now += 100) {
      serve();
    }
  }
  void serve() {
    module.poll(now);
    while (module.serve_line(now)) {
    }
  }
  void write(std::string_view characters) {
    outside.input.insert(outside.input.end(), characters.begin(), characters.end());
    serve();
    for (unsigned i = 0; i < 100; ++i) {
      serve();  // the output has more than one buffer
    }
  }
  /// The characters that the host receives for a frame.
  std::string ask(std::string_view characters) {
    outside.output.clear();
    write(characters);
    return outside.output;
  }
  /// Sends the pending frame with the lowest identifier.
  CanFrame confirm() {
    const auto first = std::ranges::min_element(outside.pending, {}, &CanFrame::identifier);
    const CanFrame frame = *first;
    outside.pending.erase(first);
    module.transmitted(now, frame);
    serve();
    return frame;
  }
  void receive(const CanFrame& frame) {
    module.receive(now, frame);
    serve();
  }

  Microseconds now = 1'000'000;
  Surroundings outside;
  test::Meters meters;
  test::FlashMemory flash;
  firmware::Module module{{gateway_node, 1, {1, 2, 3}}, {outside, outside, outside, meters, flash, &outside}};
};

TEST_F(GatewayTest, TakesTheLineAtItsStartAndOpensTheFiltersWithTheChannel) {
  EXPECT_TRUE(outside.is_connected);
  EXPECT_FALSE(outside.receives_all);
  EXPECT_EQ(ask("O\r"), "\r");
  EXPECT_TRUE(outside.receives_all);
  EXPECT_EQ(ask("C\r"), "\r");
  EXPECT_FALSE(outside.receives_all);
}

TEST_F(GatewayTest, AModuleWithoutALineIsNone) {
  firmware::Module other{{gateway_node, 1, {1, 2, 3}}, {outside, outside, outside, meters, flash}};
  other.power_on(now);
  EXPECT_FALSE(other.gateway().is_active());
}

TEST_F(GatewayTest, FramesOfTheHostGoOneAtATimeAndInTheirOrder) {
  write("O\rt7F010A\rt7F110B\rt001\rt7F210C\r");  // the third line is no frame
  ASSERT_EQ(outside.pending.size(), 1U);
  EXPECT_EQ(confirm(), (CanFrame{0x7F0, 1, {0x0A}}));
  ASSERT_EQ(outside.pending.size(), 1U);
  EXPECT_EQ(confirm(), (CanFrame{0x7F1, 1, {0x0B}}));
  EXPECT_EQ(confirm(), (CanFrame{0x7F2, 1, {0x0C}}));
  EXPECT_TRUE(outside.pending.empty());
}

TEST_F(GatewayTest, FramesOfTheModuleGoFirst) {
  write("O\r");
  outside.is_full = true;
  receive({0x604, 8, {0x40, 0x00, 0x10}});
  write("t0010\r");
  outside.is_full = false;
  serve();
  EXPECT_TRUE(outside.pending.empty()) << "the module's answer waits";
  module.transmitted(now, {0x704, 1, {}});
  serve();
  ASSERT_EQ(outside.pending.size(), 2U);
  EXPECT_EQ(outside.pending[0].identifier, 0x584);
  EXPECT_EQ(outside.pending[1].identifier, 0x001);
}

TEST_F(GatewayTest, TheModuleReceivesAFrameOfTheHostWhenAllOthersDo) {
  EXPECT_EQ(ask("O\rt60484000100000000000\r"), "\rz\r");
  ASSERT_EQ(outside.pending.size(), 1U) << "no answer before the request was sent";
  confirm();
  ASSERT_EQ(outside.pending.size(), 1U);
  EXPECT_EQ(outside.pending[0].identifier, 0x584);
  outside.output.clear();
  confirm();
  EXPECT_EQ(outside.output, "t58484300100092010200\r") << "the answer, and no echo of the request";
}

TEST_F(GatewayTest, AFrameWithAnIdentifierOfTheModuleIsACollisionAsFromAnyOtherNode) {
  write("O\rt5840\r");
  confirm();
  EXPECT_EQ(module.state(), canopen::NmtState::stopped);
}

TEST_F(GatewayTest, RejectsFramesForWhichTheQueueHasNoRoom) {
  write("O\r");
  outside.is_full = true;
  std::string answers;
  for (unsigned i = 0; i < 100; ++i) {
    answers += ask("t7F00\r");
  }
  EXPECT_EQ(std::ranges::count(answers, 'z'), 64);
  EXPECT_EQ(std::ranges::count(answers, '\a'), 36);
  EXPECT_EQ(module.gateway().frames_not_sent(), 36U);
}

TEST_F(GatewayTest, AHostThatDoesNotReadLosesWholeLinesWhichAreCounted) {
  write("O\r");
  outside.has_room = false;
  for (unsigned i = 0; i < 500; ++i) {
    receive({0x7F0, 8, {static_cast<std::uint8_t>(i), 1, 2, 3, 4, 5, 6, 7}});
  }
  outside.has_room = true;
  const std::string text = ask("");
  ASSERT_EQ(text.size() % 22, 0U);
  const std::size_t lines = text.size() / 22;
  for (std::size_t i = 0; i < lines; ++i) {
    EXPECT_EQ(text.substr(22 * i, 5), "t7F08");
    EXPECT_EQ(text[22 * i + 21], '\r');
  }
  EXPECT_GT(lines, 80U);
  EXPECT_EQ(module.gateway().frames_not_written() + lines, 500U);
}

TEST_F(GatewayTest, AtBusOffItDropsWhatWaitsAndReportsTheState) {
  write("O\rt7F00\rt7F10\rt7F20\r");
  outside.pending.clear();
  outside.state = {CanState::bus_off, 0, 255};
  module.bus_off(now);
  EXPECT_EQ(ask(""), "sb000255\r");
  EXPECT_EQ(ask("t7F00\r"), "\a");
  EXPECT_EQ(module.gateway().frames_not_sent(), 4U);
  outside.state = {};
  module.bus_back(now);
  EXPECT_EQ(ask("t7F50\r"), "sa000000\rz\r");
  EXPECT_TRUE(std::ranges::any_of(outside.pending, [](const CanFrame& it) { return it.identifier == 0x7F5; }));
}

TEST_F(GatewayTest, ReportsKindsOfErrorsTenTimesASecondAtMost) {
  write("O\r");
  wait(200'000);
  outside.output.clear();
  for (unsigned i = 0; i < 1'000; ++i) {
    outside.errors.add(CanErrorKind::stuff);
    wait(1'000);
  }
  const auto reports = std::ranges::count(outside.output, 'e');
  EXPECT_GE(reports, 9);
  EXPECT_LE(reports, 11);
  EXPECT_TRUE(outside.output.starts_with("e1s\r"));
}

TEST_F(GatewayTest, LostFramesAreAnErrorForTheHost) {
  write("O\r");
  outside.output.clear();
  module.frames_lost(now, 3);
  wait(200'000);
  EXPECT_EQ(outside.output.substr(0, 4), "e1o\r");
}

TEST_F(GatewayTest, ALineThatWasDamagedIsRejected) {
  write("O\rt7F0");
  outside.is_damaged = true;
  EXPECT_EQ(ask("0\r"), "\a");
  EXPECT_EQ(ask("t7F00\r"), "z\r");
  EXPECT_EQ(module.gateway().wrong_lines(), 1U);
}

TEST_F(GatewayTest, AResetOfTheNodeKeepsTheChannelAndPowerOnClosesIt) {
  write("O\r");
  receive({0x000, 2, {0x81, gateway_node}});
  EXPECT_EQ(ask("O\r"), "\a") << "it is open";
  module.power_on(now);
  EXPECT_EQ(ask("t7F00\r"), "\a");
  EXPECT_EQ(ask("O\r"), "\r");
}

TEST_F(GatewayTest, WhateverTheHostSendsItGetsWholeLines) {
  constexpr unsigned seed = 20;
  SCOPED_TRACE("seed " + std::to_string(seed));
  constexpr std::string_view alphabet = "tttttOCLVNFZSXTrR0123456789ABCDEFabcdef0000888\r\r\r\r\a\n?";
  std::mt19937 random(seed);
  write("O\r");
  for (unsigned i = 0; i < 300'000; ++i) {
    outside.input.push_back(alphabet[random() % alphabet.size()]);
    outside.is_damaged = random() % 1'000 == 0;
    outside.has_room = random() % 4 != 0;
    outside.is_full = random() % 3 == 0;
    if (random() % 8 == 0) {
      receive({static_cast<std::uint16_t>(0x780 + random() % 0x80), static_cast<std::uint8_t>(random() % 9), {}});
    }
    serve();
    if (const auto place = std::ranges::min_element(outside.pending, {}, &CanFrame::identifier);
        place != outside.pending.end()) {
      const CanFrame frame = *place;
      outside.pending.erase(place);
      module.transmitted(now, frame);
    }
    now += 100;
  }
  ASSERT_GT(outside.output.size(), 100'000U);
  std::string line;
  for (const char character : outside.output) {
    line.push_back(character);
    if (character != '\r' && character != '\a') {
      ASSERT_LT(line.size(), 30U) << line;
      continue;
    }
    const bool is_frame = line.front() == 't' && line[4] <= '8' &&
                          (line.size() == 6U + 2U * static_cast<unsigned>(line[4] - '0') ||
                           line.size() == 10U + 2U * static_cast<unsigned>(line[4] - '0'));
    const bool is_answer = line == "\r" || line == "\a" || line == "z\r" || line == "V1010\r" || line.size() == 4 ||
                           (line.front() == 'N' && line.size() == 6);
    ASSERT_TRUE(is_frame || is_answer) << line;
    line.clear();
  }
}

}  // namespace
}  // namespace proleg
