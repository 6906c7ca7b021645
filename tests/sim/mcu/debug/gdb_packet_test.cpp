// Oracle: "Debugging with GDB", appendix E.1.

#include "sim/mcu/debug/gdb_packet.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

namespace proleg::sim {
namespace {

using Kind = GdbInput::Kind;

std::vector<GdbInput> inputs_of(std::string_view bytes, std::size_t portion = std::string_view::npos) {
  GdbDecoder decoder;
  std::vector<GdbInput> inputs;
  for (std::size_t at = 0; at < bytes.size(); at += std::min(portion, bytes.size())) {
    decoder.feed(bytes.substr(at, portion));
    while (auto input = decoder.next()) {
      inputs.push_back(std::move(*input));
    }
  }
  return inputs;
}

std::string random_bytes(std::mt19937_64& random, std::size_t longest) {
  std::string bytes(random() % (longest + 1), '\0');
  for (char& byte : bytes) {
    byte = static_cast<char>(random());
  }
  return bytes;
}

TEST(GdbPacket, CarriesTheSumOfItsBytes) {
  EXPECT_EQ(gdb_packet(""), "$#00");
  EXPECT_EQ(gdb_packet("OK"), "$OK#9a");
  EXPECT_EQ(gdb_packet("qC"), "$qC#b4");
}

TEST(GdbPacket, EscapesWhatThePacketItselfIsMadeOf) { EXPECT_EQ(gdb_packet("#$}*"), "$}\x03}\x04}]}\n#62"); }

TEST(GdbPacket, IsDecodedToThePayloadInPortionsOfAnySize) {
  constexpr unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 2000; ++round) {
    const std::string payload = random_bytes(random, 300);
    const auto inputs = inputs_of(gdb_packet(payload), 1 + random() % 50);
    ASSERT_EQ(inputs.size(), 1U);
    EXPECT_EQ(inputs[0].kind, Kind::packet);
    EXPECT_EQ(inputs[0].payload, payload);
  }
}

TEST(GdbPacket, WithAnyOtherChecksumIsDamaged) {
  constexpr unsigned seed = 12;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 4; ++round) {
    const std::string packet = gdb_packet(random_bytes(random, 40));
    const std::string body = packet.substr(0, packet.size() - 2);
    int accepted = 0;
    // Any two characters, digits or not; '$' would start another packet.
    for (unsigned first = 0; first < 256; ++first) {
      for (unsigned second = 0; second < 256; ++second) {
        if (first == '$' || second == '$') {
          continue;
        }
        const auto inputs = inputs_of(body + static_cast<char>(first) + static_cast<char>(second));
        ASSERT_EQ(inputs.size(), 1U);
        accepted += inputs[0].kind == Kind::packet ? 1 : 0;
        ASSERT_TRUE(inputs[0].kind == Kind::packet || inputs[0].kind == Kind::damaged);
      }
    }
    // Both digits may be upper or lower case, if they are letters.
    const auto cases = [](char digit) { return digit >= 'a' ? 2 : 1; };
    EXPECT_EQ(accepted, cases(packet[packet.size() - 2]) * cases(packet.back())) << packet;
  }
}

TEST(GdbPacket, WithOneByteChangedIsNeverTakenForAnotherPacket) {
  const std::string packet = gdb_packet("m20000000,40");
  for (std::size_t at = 1; at < packet.size() - 3; ++at) {
    for (unsigned value = 0; value < 256; ++value) {
      std::string changed = packet;
      changed[at] = static_cast<char>(value);
      for (const GdbInput& input : inputs_of(changed)) {
        EXPECT_TRUE(input.kind != Kind::packet || changed == packet) << changed;
      }
    }
  }
}

TEST(GdbDecoder, SeparatesAcknowledgementsAndInterruptsFromPacketsAndIgnoresTheRest) {
  const auto inputs = inputs_of("+ abc-\x03$OK#9a#12+");
  ASSERT_EQ(inputs.size(), 5U);
  EXPECT_EQ(inputs[0].kind, Kind::accepted);
  EXPECT_EQ(inputs[1].kind, Kind::refused);
  EXPECT_EQ(inputs[2].kind, Kind::interrupt);
  EXPECT_EQ(inputs[3].kind, Kind::packet);
  EXPECT_EQ(inputs[4].kind, Kind::accepted);
}

TEST(GdbDecoder, TreatsAnInterruptByteWithinAPacketAsContent) {
  const auto inputs = inputs_of(gdb_packet("X0,1:\x03"));
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].payload, "X0,1:\x03");
}

TEST(GdbDecoder, StartsAgainAtADollarSign) {
  const auto inputs = inputs_of("$m2000$OK#$OK#9a");
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].payload, "OK");
}

TEST(GdbDecoder, AcceptsTheLongestPacketAndNoLongerOne) {
  const std::string longest(GdbDecoder::max_packet, 'x');
  auto inputs = inputs_of(gdb_packet(longest) + gdb_packet(longest + "x") + gdb_packet("OK"));
  ASSERT_EQ(inputs.size(), 3U);
  EXPECT_EQ(inputs[0].payload, longest);
  EXPECT_EQ(inputs[1].kind, Kind::too_long);
  EXPECT_EQ(inputs[2].payload, "OK");
}

TEST(GdbHex, IsReadBackAndRejectsEverythingElse) {
  std::vector<std::uint8_t> all(256);
  for (unsigned i = 0; i < all.size(); ++i) {
    all[i] = static_cast<std::uint8_t>(i);
  }
  EXPECT_EQ(from_hex(to_hex(all)), all);
  EXPECT_EQ(to_hex(std::vector<std::uint8_t>{0x0F, 0xA0}), "0fa0");
  for (const char* const bad : {"0", "0g", "x0", "-1", " 1", "0x10"}) {
    EXPECT_FALSE(from_hex(bad)) << bad;
  }
  EXPECT_EQ(hex_number("FFFFffff"), std::numeric_limits<std::uint32_t>::max());
  for (const char* const bad : {"", "100000000", "-1", "+1", "0x1", "1 ", "g"}) {
    EXPECT_FALSE(hex_number(bad)) << bad;
  }
}

}  // namespace
}  // namespace proleg::sim
