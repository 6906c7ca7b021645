#include "shared/canopen/messages.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "frame_text.hpp"

namespace proleg::canopen {
namespace {

using test::frame;

/// Checks that the message encodes to that frame, that the frame decodes to that message, and that docs/protocol.md has
/// it as an example.
template <typename Message>
void expect_example(const std::string& text, const Message& message,
                    const std::function<std::optional<Message>(const CanFrame&)>& decode) {
  EXPECT_TRUE(test::is_documented(text)) << text;
  EXPECT_EQ(encode(message), frame(text));
  ASSERT_TRUE(decode(frame(text)).has_value()) << text;
  EXPECT_EQ(*decode(frame(text)), message) << text;
}

TEST(Messages, AreTheExamplesOfTheDocumentation) {
  EXPECT_TRUE(test::is_documented("080 [1] 2D"));
  EXPECT_EQ(encode_sync(300), frame("080 [1] 2D"));
  EXPECT_EQ(decode_sync(frame("080 [1] 2D")), 300 % 128 + 1);

  expect_example<TickMessage>("681 [8] 2C 01 00 00 E2 C3 17 5A", {300, 0x5A17C3E2}, decode_tick);
  expect_example<CommitMessage>("680 [8] 07 00 40 01 00 00 01 00", {7, 320, 1}, decode_commit);
  expect_example<NmtRequest>("000 [2] 01 03", {NmtCommand::start, 3}, decode_nmt);
  expect_example<Heartbeat>("703 [1] 00", {3, NmtState::boot_up}, decode_heartbeat);
  expect_example<Heartbeat>("703 [1] 05", {3, NmtState::operational}, decode_heartbeat);
  expect_example<Heartbeat>("77F [1] 05", {host_node, NmtState::operational}, decode_heartbeat);
  expect_example<Emergency>("083 [8] 10 23 03 00 00 00 00 00", {3, EmergencyCode::over_current, 3, 0},
                            decode_emergency);
  expect_example<Emergency>("083 [8] 40 81 11 1F 00 00 00 00", {3, EmergencyCode::bus_off_recovered, 0x11, 31},
                            decode_emergency);
  expect_example<Emergency>("083 [8] 10 60 00 00 00 00 00 00", {3, EmergencyCode::watchdog_reset, 0, 0},
                            decode_emergency);
  expect_example<Command>("203 [6] 0F 00 00 00 00 20", {3, 0x000F, 1 << 29}, decode_command);
  // 44.9 degrees are 8173.7 steps of 90 / 2^14 degrees.
  expect_example<Monitoring>("383 [6] EE 1F 5E 01 1F 00", {3, 8174, 350, 31, 0}, decode_monitoring);

  for (const auto& [channel, text] :
       {std::pair(0U, "183 [8] 8E E3 38 4E 72 1C 83 2C"), std::pair(1U, "283 [8] 00 00 00 20 00 00 83 2C")}) {
    EXPECT_TRUE(test::is_documented(text));
    const std::optional<StateFrame> state = decode_state(frame(text));
    ASSERT_TRUE(state.has_value());
    EXPECT_EQ(state->label(), 300 % 256);
    EXPECT_EQ(state->flags(), StateFrame::valid | StateFrame::rear_link_contact_bits);
    EXPECT_EQ(encode_state(3, channel, *state), frame(text));
  }
}

TEST(Messages, SyncCountsFromOneTo128AndAround) {
  EXPECT_EQ(decode_sync(encode_sync(0)), 1);
  EXPECT_EQ(decode_sync(encode_sync(127)), 128);
  EXPECT_EQ(decode_sync(encode_sync(128)), 1);
  EXPECT_EQ(decode_sync(encode_sync(0xFFFFFFFF)), 128);
}

TEST(Messages, NegativeAnglesAndTemperaturesSurvive) {
  const Command command{126, 0x0080, -(1 << 30)};
  EXPECT_EQ(encode(command), frame("27E [6] 80 00 00 00 00 C0"));
  EXPECT_EQ(decode_command(encode(command)), command);
  const Monitoring monitoring{1, -16384, 65535, -40, 0xFF};
  EXPECT_EQ(encode(monitoring), frame("381 [6] 00 C0 FF FF D8 FF"));
  EXPECT_EQ(decode_monitoring(encode(monitoring)), monitoring);
}

TEST(Messages, AMonitoredAngleIsRoundedHalfUpAndMarkedIfNotMeasured) {
  EXPECT_EQ(monitored_angle(std::nullopt), -0x8000);
  EXPECT_EQ(monitored_angle(1 << 30), 1 << 14) << "90 degrees";
  EXPECT_EQ(monitored_angle(-(1 << 30)), -(1 << 14));
  EXPECT_EQ(monitored_angle(0x7FFF), 0);
  EXPECT_EQ(monitored_angle(0x8000), 1);
  EXPECT_EQ(monitored_angle(-0x8000), 0);
  EXPECT_EQ(monitored_angle(-0x8001), -1);
  EXPECT_EQ(monitored_angle(0x7FFFFFFF), 0x7FFF);
  EXPECT_EQ(monitored_angle(-0x7FFFFFFF - 1), -0x7FFF) << "the minimum, which is not the mark";
}

/// Every message with a decoder, behind the same interface: it decodes and encodes again.
struct Codec {
  const char* name;
  std::function<std::optional<CanFrame>(const CanFrame&)> recode;
};

template <typename Decode>
Codec codec(const char* name, Decode decode) {
  return {name, [decode](const CanFrame& frame) -> std::optional<CanFrame> {
            const auto message = decode(frame);
            return message ? std::optional(encode(*message)) : std::nullopt;
          }};
}

const std::vector<Codec>& codecs() {
  static const std::vector<Codec> all{
      codec("NMT", decode_nmt),
      codec("heartbeat", decode_heartbeat),
      {"SYNC",
       [](const CanFrame& frame) -> std::optional<CanFrame> {
         const std::optional<std::uint8_t> counter = decode_sync(frame);
         return counter ? std::optional(encode_sync(*counter - 1U)) : std::nullopt;
       }},
      codec("TICK", decode_tick),
      codec("COMMIT", decode_commit),
      codec("EMCY", decode_emergency),
      codec("command", decode_command),
      codec("monitoring", decode_monitoring),
  };
  return all;
}

bool is_command(const CanFrame& frame) {
  return frame.identifier > identifier::command && frame.identifier <= identifier::command + max_node_id;
}
/// If a PDO is longer than its mapping, the mapped part is used (CiA 301, 7.2.2.5.1).
CanFrame mapped_part(CanFrame frame) {
  if (is_command(frame)) {
    frame.length = std::min<std::uint8_t>(frame.length, 6);
    std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{0});
  }
  return frame;
}

TEST(Messages, NothingIsReadFromAnyFrameButItsOwnAndThenEveryBit) {
  constexpr std::uint32_t seed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<unsigned> read(codecs().size());
  constexpr std::uint16_t single[] = {identifier::nmt, identifier::sync, identifier::commit, identifier::tick};
  for (int run = 0; run < 400'000; ++run) {
    const bool any = random() % 2 == 0;
    CanFrame candidate = test::random_frame(
        random, any ? static_cast<std::uint16_t>(random() % 0x800) : single[random() % std::size(single)]);
    if (random() % 2 == 0) {
      candidate.data[0] &= candidate.length > 0 ? 0x85U : 0U;  // more often a state or a command
      candidate.data[7] = 0;
    }
    unsigned readers = 0;
    for (std::size_t i = 0; i < codecs().size(); ++i) {
      if (const std::optional<CanFrame> again = codecs()[i].recode(candidate)) {
        ++readers;
        ++read[i];
        ASSERT_EQ(*again, mapped_part(candidate)) << codecs()[i].name;
      }
    }
    ASSERT_LE(readers, 1U) << test::text(candidate);
    const std::optional<StateFrame> state = decode_state(candidate);
    ASSERT_EQ(state.has_value(), candidate.length == 8);
    if (state) {
      ASSERT_EQ(state->bytes, candidate.data);
    }
  }
  for (std::size_t i = 0; i < codecs().size(); ++i) {
    EXPECT_GT(read[i], 50U) << codecs()[i].name;
  }
}

TEST(Messages, OfAnotherLengthAreNotRead) {
  for (const char* text : {"000 [2] 01 03", "703 [1] 05", "080 [1] 2D", "681 [8] 2C 01 00 00 E2 C3 17 5A",
                           "680 [8] 07 00 40 01 00 00 01 00", "083 [8] 10 23 02 00 00 00 00 00",
                           "203 [6] 0F 00 00 00 00 20", "383 [6] EE 1F 5E 01 1F 00"}) {
    const CanFrame right = frame(text);
    for (std::uint8_t length = 0; length <= 8; ++length) {
      CanFrame candidate = right;
      candidate.length = length;
      unsigned readers = 0;
      for (const Codec& codec : codecs()) {
        readers += codec.recode(candidate).has_value() ? 1U : 0U;
      }
      const bool is_read = length == right.length || (is_command(right) && length > right.length);
      EXPECT_EQ(readers, is_read ? 1U : 0U) << text << " cut to " << unsigned{length};
    }
  }
}

TEST(Messages, WhatTheProtocolDoesNotAllowIsNotRead) {
  EXPECT_FALSE(decode_nmt(frame("000 [2] 03 03"))) << "no such command";
  EXPECT_FALSE(decode_nmt(frame("000 [2] 01 80"))) << "no such node";
  EXPECT_TRUE(decode_nmt(frame("000 [2] 01 00"))) << "all nodes";
  EXPECT_FALSE(decode_heartbeat(frame("703 [1] 06"))) << "no such state";
  EXPECT_FALSE(decode_heartbeat(frame("703 [1] 85"))) << "toggle bit of node guarding";
  EXPECT_FALSE(decode_heartbeat(frame("700 [1] 05"))) << "no node 0";
  EXPECT_FALSE(decode_heartbeat(frame("780 [1] 05"))) << "no node 128";
  EXPECT_FALSE(decode_sync(frame("080 [1] 00")));
  EXPECT_FALSE(decode_sync(frame("080 [1] 81")));
  EXPECT_FALSE(decode_emergency(frame("080 [8] 10 23 02 00 00 00 00 00"))) << "no node 0";
  EXPECT_FALSE(decode_emergency(frame("100 [8] 10 23 02 00 00 00 00 00"))) << "no node 128";
  EXPECT_FALSE(decode_emergency(frame("083 [8] 10 23 02 00 00 00 00 01"))) << "byte 7 is 0";
  EXPECT_EQ(decode_command(frame("203 [8] 0F 00 00 00 00 20 AA BB")), (Command{3, 0x000F, 1 << 29}))
      << "the mapped part";
  EXPECT_FALSE(decode_command(frame("27F [6] 0F 00 00 00 00 20"))) << "the host is not commanded";
}

TEST(Messages, EmergenciesHaveNames) {
  EXPECT_EQ(describe(EmergencyCode::over_current), "over-current");
  EXPECT_EQ(describe(EmergencyCode::bus_off_recovered), "back after bus-off");
  EXPECT_EQ(describe(EmergencyCode::watchdog_reset), "reset by the watchdog");
  EXPECT_EQ(describe(EmergencyCode::supply_low), "supply voltage too low");
  EXPECT_EQ(describe(EmergencyCode::sensors_failed), "the sensors of the servo do not measure");
  EXPECT_EQ(describe(EmergencyCode::frames_lost), "received frames lost");
  EXPECT_EQ(describe(EmergencyCode::clock_failure), "reset after a failure of the crystal or the PLL");
  EXPECT_EQ(describe(EmergencyCode::software_fault), "reset after a fault of the program");
  EXPECT_EQ(describe(static_cast<EmergencyCode>(0x1234)), "unknown emergency code");
  const std::optional<Emergency> foreign = decode_emergency(frame("083 [8] 34 12 01 04 03 02 01 00"));
  ASSERT_TRUE(foreign) << "a code of a later version is handed on";
  EXPECT_EQ(foreign->code, static_cast<EmergencyCode>(0x1234));
  EXPECT_EQ(foreign->detail, 0x01020304U);
}

}  // namespace
}  // namespace proleg::canopen
