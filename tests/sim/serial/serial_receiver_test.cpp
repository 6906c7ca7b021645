#include "sim/serial/serial_line.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace proleg::sim {
namespace {

using Kind = SerialReceiver::Kind;
constexpr SerialReceiver::Time bit = 1'000;

/// All that the receiver finds up to a time.
std::vector<SerialReceiver::Event> events(SerialReceiver& receiver, SerialReceiver::Time until,
                                          SerialReceiver::Time receivers_bit = bit) {
  std::vector<SerialReceiver::Event> found;
  while (receiver.next_event(receivers_bit) <= until) {
    found.push_back(receiver.take(until, receivers_bit).value());
  }
  return found;
}

TEST(SerialReceiver, FindsACharacterInTheMiddleOfItsStopBitAndThenAnIdleLine) {
  for (unsigned byte = 0; byte < 256; ++byte) {
    SerialReceiver receiver;
    receiver.begin(5'000, {static_cast<std::uint8_t>(byte)}, bit);
    const auto found = events(receiver, 1'000'000);
    ASSERT_EQ(found.size(), 2U) << byte;
    EXPECT_EQ(found[0].kind, Kind::character);
    EXPECT_EQ(found[0].character, (SerialCharacter{static_cast<std::uint8_t>(byte), true})) << byte;
    EXPECT_EQ(found[0].time, 5'000U + 9'500U);
    EXPECT_EQ(found[1].kind, Kind::idle);
    EXPECT_EQ(found[1].time, 5'000U + 20'000U);
    EXPECT_FALSE(receiver.is_busy());
  }
}

TEST(SerialReceiver, FindsNoIdleLineBetweenCharactersThatFollowEachOther) {
  SerialReceiver receiver;
  std::vector<SerialReceiver::Event> found;
  for (unsigned i = 0; i < 5; ++i) {
    const SerialReceiver::Time start = i * 19'999;  // the line is high for less than a character
    receiver.begin(start, {static_cast<std::uint8_t>(0x30 + i)}, bit);
    for (const auto& event : events(receiver, start + 19'998)) {
      found.push_back(event);
    }
  }
  ASSERT_EQ(found.size(), 5U);
  for (unsigned i = 0; i < 5; ++i) {
    EXPECT_EQ(found[i].character.byte, 0x30U + i);
  }
}

TEST(SerialReceiver, ToleratesASenderThatIsAFewPercentOff) {
  for (const SerialReceiver::Time senders_bit : {960U, 1'040U}) {
    SerialReceiver receiver;
    receiver.begin(0, {0xA5}, senders_bit);
    const auto found = events(receiver, 15'000);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].character, (SerialCharacter{0xA5, true}));
  }
}

// 115,200 baud at a receiver of 1,000,000: each bit is sampled about nine times.
TEST(SerialReceiver, FindsOtherCharactersIfTheSenderIsSlow) {
  SerialReceiver receiver;
  receiver.begin(0, {'U'}, 8'681);
  const auto found = events(receiver, 80'000);
  ASSERT_GE(found.size(), 4U);
  for (const auto& event : found) {
    EXPECT_NE(event.character.byte, 'U');
  }
}

TEST(SerialReceiver, ABreakIsOneCharacterWithoutStopBit) {
  SerialReceiver receiver;
  receiver.begin(0, {0x00, false}, 100'000);  // low for a millisecond
  const auto found = events(receiver, 2'000'000);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].character, (SerialCharacter{0, false}));
  EXPECT_EQ(found[1].kind, Kind::idle);
  EXPECT_EQ(found[1].time, 1'000'000U + 10'000U);
}

TEST(SerialSender, SendsCharactersWithoutGapAndLaterOnesNotBeforeTheirTime) {
  SerialSender sender(1'000'000);
  sender.send(5'000, "ab");
  sender.send(100'000, "c");
  EXPECT_EQ(sender.next_event(), 5'000U);
  EXPECT_EQ(sender.take(4'999), std::nullopt);
  EXPECT_EQ(sender.take(5'000)->byte, 'a');
  EXPECT_EQ(sender.next_event(), 15'000U);
  EXPECT_EQ(sender.take(15'000)->byte, 'b');
  EXPECT_EQ(sender.next_event(), 100'000U);
  sender.clear();
  EXPECT_EQ(sender.next_event(), never_on_bus);
}

}  // namespace
}  // namespace proleg::sim
