// Oracle: ISO 11898-1, bit by bit. The frame is written out as text, the CRC is the remainder of a long division of
// polynomials, and stuff bits are inserted into the text.

#include "sim/bus/frame_bits.hpp"

#include <gtest/gtest.h>

#include <string>

#include "frames.hpp"

namespace proleg::sim {
namespace {

std::string binary(unsigned value, unsigned digits) {
  std::string text;
  while (digits-- > 0) {
    text += ((value >> digits) & 1U) != 0 ? '1' : '0';
  }
  return text;
}

/// Remainder of bits * x^15 divided by x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1 (ISO 11898-1).
std::string remainder_of(const std::string& bits) {
  const std::string divisor = "1100010110011001";
  std::string dividend = bits + std::string(15, '0');
  for (std::size_t at = 0; at < bits.size(); ++at) {
    if (dividend[at] == '1') {
      for (std::size_t i = 0; i < divisor.size(); ++i) {
        dividend[at + i] = dividend[at + i] == divisor[i] ? '0' : '1';
      }
    }
  }
  return dividend.substr(bits.size());
}

std::string stuffed(std::string bits) {
  for (std::size_t end = 5; end <= bits.size(); ++end) {
    if (bits.compare(end - 5, 5, "00000") == 0) {
      bits.insert(end, 1, '1');
    } else if (bits.compare(end - 5, 5, "11111") == 0) {
      bits.insert(end, 1, '0');
    }
  }
  return bits;
}

std::string bits_before_crc(const CanFrame& frame) {
  const std::string start_of_frame = "0";
  const std::string rtr_ide_r0 = "000";
  std::string bits = start_of_frame + binary(frame.identifier, 11) + rtr_ide_r0 + binary(frame.length, 4);
  for (const std::uint8_t byte : frame.bytes()) {
    bits += binary(byte, 8);
  }
  return bits;
}

std::string wire_bits(const CanFrame& frame) {
  const std::string crc_delimiter = "1";
  const std::string ack_slot_and_delimiter = "01";
  const std::string end_of_frame = "1111111";
  const std::string bits = bits_before_crc(frame);
  return stuffed(bits + remainder_of(bits)) + crc_delimiter + ack_slot_and_delimiter + end_of_frame;
}

TEST(FrameBits, ModelsRemainderHasThePublishedCheckValueOfCrc15Can) {
  std::string digits;  // catalogue of parametrised CRC algorithms, CRC-15/CAN: check = 0x059E for "123456789"
  for (const char digit : std::string("123456789")) {
    digits += binary(static_cast<unsigned>(digit), 8);
  }
  EXPECT_EQ(remainder_of(digits), binary(0x059E, 15));
}

TEST(FrameBits, ModelStuffsAsTheStandardsExamplesSay) {
  EXPECT_EQ(stuffed("00000"), "000001");
  EXPECT_EQ(stuffed("11111"), "111110");
  EXPECT_EQ(stuffed("000001111"),
            "0000011111"
            "0");  // a stuff bit counts for the next run
  EXPECT_EQ(stuffed("0000100001"), "0000100001");
}

TEST(FrameBits, EveryIdentifierWithoutDataAgreesWithTheModel) {
  for (std::uint16_t identifier = 0; identifier <= CanFrame::max_identifier; ++identifier) {
    const CanFrame frame = frame_of(identifier);
    ASSERT_EQ(frame_bits(frame), wire_bits(frame).size()) << identifier;
    ASSERT_EQ(binary(crc_sequence(frame), 15), remainder_of(bits_before_crc(frame))) << identifier;
  }
}

TEST(FrameBits, RandomFramesOfEveryLengthAgreeWithTheModel) {
  constexpr unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (std::uint8_t length = 0; length <= 8; ++length) {
    for (int i = 0; i < 4000; ++i) {
      const CanFrame frame = random_frame(static_cast<std::uint16_t>(random() & 0x7FFU), length, random);
      ASSERT_EQ(frame_bits(frame), wire_bits(frame).size()) << wire_bits(frame);
      ASSERT_EQ(binary(crc_sequence(frame), 15), remainder_of(bits_before_crc(frame))) << wire_bits(frame);
    }
  }
}

TEST(FrameBits, AStuffBitFollowsTheCrcThatEndsInFiveEqualBits) {
  unsigned found = 0;
  for (std::uint16_t identifier = 0; identifier <= CanFrame::max_identifier; ++identifier) {
    const CanFrame frame = frame_of(identifier);
    const std::string bits = bits_before_crc(frame) + remainder_of(bits_before_crc(frame));
    const std::string all = stuffed(bits);
    if (all.size() > stuffed(bits.substr(0, bits.size() - 1)).size() + 1) {
      ++found;
      EXPECT_EQ(frame_bits(frame), all.size() + 10);
    }
  }
  EXPECT_GT(found, 10U);
}

TEST(FrameBits, LiesBetweenTheBestAndTheWorstCase) {
  constexpr unsigned seed = 12;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100'000; ++i) {
    const auto length = static_cast<std::uint8_t>(random() % 9);
    const CanFrame frame = random_frame(static_cast<std::uint16_t>(random() & 0x7FFU), length, random);
    const unsigned stuffable =
        34U + 8U * length;  // at most one stuff bit after the first five, then one after each four
    ASSERT_GE(frame_bits(frame), stuffable + 10);
    ASSERT_LE(frame_bits(frame), stuffable + 10 + (stuffable - 1) / 4);
  }
}

TEST(FrameBits, SyncAndStateFramesAreAsLongAsTheProtocolSays) {
  for (std::uint8_t counter = 1; counter <= 128; ++counter) {
    const unsigned bits = frame_bits(frame_of(0x080, {counter})) + interframe_bits;
    EXPECT_GE(bits, 55U);
    EXPECT_LE(bits, 65U);
  }
  constexpr unsigned seed = 13;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (std::uint16_t node = 1; node <= 126; ++node) {
    for (int i = 0; i < 500; ++i) {
      const unsigned bits =
          frame_bits(random_frame(static_cast<std::uint16_t>(0x180 + node), 8, random)) + interframe_bits;
      ASSERT_GE(bits, 111U);
      ASSERT_LE(bits, 135U);
    }
  }
}

}  // namespace
}  // namespace proleg::sim
