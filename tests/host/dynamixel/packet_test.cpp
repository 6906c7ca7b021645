// The packets of the examples in the e-manual ("Protocol 2.0", Instruction Details) with their published CRCs, and what
// the parser does with packets that are not intact.

#include "host/dynamixel/packet.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "tests/host/dynamixel/servo_emulator.hpp"

namespace proleg::host {
namespace {

using test::Bytes;
using test::reference_packet;

Bytes packet(std::uint8_t id, Instruction instruction, const Bytes& parameters) {
  return instruction_packet(id, instruction, parameters);
}

std::vector<StatusPacket> parse(std::span<const std::uint8_t> bytes, StatusParser parser = {}) {
  parser.add(bytes);
  std::vector<StatusPacket> packets;
  while (auto next = parser.next()) {
    packets.push_back(*next);
  }
  return packets;
}

const Bytes ping_status{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x55, 0x00, 0x06, 0x04, 0x26, 0x65, 0x5D};
const Bytes read_status{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x08, 0x00, 0x55, 0x00, 0xA6, 0x00, 0x00, 0x00, 0x8C, 0xC0};
const Bytes write_status{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x04, 0x00, 0x55, 0x00, 0xA1, 0x0C};

TEST(DynamixelInstruction, IsThatOfTheManual) {
  EXPECT_EQ(packet(1, Instruction::ping, {}), (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E}));
  EXPECT_EQ(packet(0xFE, Instruction::ping, {}), (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x03, 0x00, 0x01, 0x31, 0x42}));
  EXPECT_EQ(packet(1, Instruction::read, {0x84, 0x00, 0x04, 0x00}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x02, 0x84, 0x00, 0x04, 0x00, 0x1D, 0x15}));
  EXPECT_EQ(packet(1, Instruction::write, {0x74, 0x00, 0x00, 0x02, 0x00, 0x00}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x09, 0x00, 0x03, 0x74, 0x00, 0x00, 0x02, 0x00, 0x00, 0xCA, 0x89}));
  EXPECT_EQ(packet(1, Instruction::reboot, {}), (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x08, 0x2F, 0x4E}));
  EXPECT_EQ(packet(0xFE, Instruction::sync_read, {0x84, 0x00, 0x04, 0x00, 0x01, 0x02}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x09, 0x00, 0x82, 0x84, 0x00, 0x04, 0x00, 0x01, 0x02, 0xCE, 0xFA}));
  EXPECT_EQ(packet(0xFE, Instruction::sync_write,
                   {0x74, 0x00, 0x04, 0x00, 0x01, 0x96, 0x00, 0x00, 0x00, 0x02, 0xAA, 0x00, 0x00, 0x00}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0xFE, 0x11, 0x00, 0x83, 0x74, 0x00, 0x04, 0x00,
                   0x01, 0x96, 0x00, 0x00, 0x00, 0x02, 0xAA, 0x00, 0x00, 0x00, 0x82, 0x87}));
}

TEST(DynamixelStatus, IsThatOfTheManual) {
  EXPECT_EQ(parse(ping_status), (std::vector<StatusPacket>{{1, 0, {0x06, 0x04, 0x26}}}));
  EXPECT_EQ(parse(read_status), (std::vector<StatusPacket>{{1, 0, {0xA6, 0x00, 0x00, 0x00}}}));
  EXPECT_EQ(parse(write_status), (std::vector<StatusPacket>{{1, 0, {}}}));
  // Sync read: one packet of each servo.
  Bytes both = read_status;
  const Bytes second{0xFF, 0xFF, 0xFD, 0x00, 0x02, 0x08, 0x00, 0x55, 0x00, 0x1F, 0x08, 0x00, 0x00, 0xBA, 0xBE};
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_EQ(parse(both), (std::vector<StatusPacket>{{1, 0, {0xA6, 0, 0, 0}}, {2, 0, {0x1F, 0x08, 0, 0}}}));
}

TEST(DynamixelInstruction, HasNoHeaderInside) {
  // The rule of the e-manual: FF FF FD in the parameters becomes FF FF FD FD, and the length counts it.
  const Bytes stuffed = packet(1, Instruction::write, {0x74, 0x00, 0xFF, 0xFF, 0xFD, 0x00});
  EXPECT_EQ(Bytes(stuffed.begin() + 5, stuffed.end() - 2),
            (Bytes{0x0A, 0x00, 0x03, 0x74, 0x00, 0xFF, 0xFF, 0xFD, 0xFD, 0x00}));
}

TEST(DynamixelPackets, EqualThoseOfAnotherProgramForRandomContents) {
  constexpr unsigned seed = 2026;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  constexpr std::array<std::uint8_t, 4> bytes{0xFF, 0xFD, 0x00, 0x55};
  for (int i = 0; i < 3000; ++i) {
    Bytes data(random() % 60);
    for (std::uint8_t& byte : data) {
      byte = bytes[random() % bytes.size()];  // headers are frequent
    }
    Bytes body{static_cast<std::uint8_t>(Instruction::write)};
    body.insert(body.end(), data.begin(), data.end());
    ASSERT_EQ(packet(7, Instruction::write, data), reference_packet(7, body));
    body[0] = 0x55;
    body.insert(body.begin() + 1, 0x80);
    ASSERT_EQ(parse(reference_packet(7, body)), (std::vector<StatusPacket>{{7, 0x80, data}}));
  }
}

TEST(DynamixelStatus, IsFoundByteByByteAndAfterNoise) {
  StatusParser parser;
  const Bytes noise{0x00, 0xFF, 0xFF, 0xFF, 0xFD, 0xFF, 0xFF};
  parser.add(noise);
  EXPECT_FALSE(parser.next());
  for (std::size_t i = 0; i < ping_status.size(); ++i) {
    EXPECT_FALSE(parser.next()) << i;
    parser.add(std::span(ping_status).subspan(i, 1));
  }
  EXPECT_TRUE(parser.next());
  EXPECT_EQ(parser.damaged(), 0U);
}

TEST(DynamixelStatus, IsNeitherTheEchoOfAnInstructionNorADamagedPacket) {
  EXPECT_TRUE(parse(packet(1, Instruction::ping, {})).empty());
  for (std::size_t at = 0; at < ping_status.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes damaged = ping_status;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 1U << bit);
      EXPECT_TRUE(parse(damaged).empty()) << at << ' ' << bit;
    }
  }
}

TEST(DynamixelStatus, BehindADamagedOrTruncatedOneIsFound) {
  Bytes truncated(ping_status.begin(), ping_status.end() - 4);
  truncated.insert(truncated.end(), read_status.begin(), read_status.end());
  EXPECT_EQ(parse(truncated), (std::vector<StatusPacket>{{1, 0, {0xA6, 0, 0, 0}}}));
  Bytes corrupt = ping_status;
  corrupt[9] ^= 1U;
  corrupt.insert(corrupt.end(), read_status.begin(), read_status.end());
  EXPECT_EQ(parse(corrupt).size(), 1U);
  // A length that no answer has does not make the parser wait for the bytes.
  Bytes endless{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0xFF, 0xFF, 0x55};
  endless.insert(endless.end(), write_status.begin(), write_status.end());
  EXPECT_EQ(parse(endless).size(), 1U);
}

TEST(DynamixelStatus, ThatIsIncompleteIsForgottenIfItIsTooLong) {
  const std::span<const std::uint8_t> bytes(read_status);  // four parameters
  for (const std::size_t parameters : {3U, 4U}) {
    StatusParser parser;
    parser.add(bytes.first(9));
    EXPECT_FALSE(parser.next());
    parser.forget_longer_than(parameters);
    parser.add(bytes.subspan(9));
    EXPECT_EQ(parser.next().has_value(), parameters == 4U);
  }
}

}  // namespace
}  // namespace proleg::host
