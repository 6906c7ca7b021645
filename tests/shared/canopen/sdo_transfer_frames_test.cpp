// Segmented and block transfers of the SDO server, frame by frame as the tables of CiA 301, 7.2.4.3 have them.

#include <gtest/gtest.h>

#include <string>

#include "device_memory.hpp"
#include "frame_text.hpp"

namespace proleg::canopen {
namespace {

using test::frame;
using test::text;

constexpr Address domain{0x1F50, 1};
constexpr Address short_text{0x2F00, 0};
constexpr Address write_only{0x2F01, 0};

class SdoFrames : public testing::Test {
 protected:
  SdoFrames() {
    device.add_entry(domain, DataType::domain, 0, 1'000'000);
    device.add_entry(short_text, DataType::visible_string, 2, 10);
    device.add_entry(write_only, DataType::octet_string, 0, 100, Access::write_only);
    device.set_text({0x1008, 0}, "Proleg joint module");
  }

  /// The answer of node 3 as text; "" without an answer.
  std::string answer(const std::string& request) {
    const std::optional<CanFrame> reply = server.receive(now, frame("603 [8] " + request));
    return reply ? text(*reply).substr(8) : "";
  }
  /// The answer of node 3, if docs/protocol.md has the request and the answer as examples.
  std::string documented_answer(const std::string& request) {
    EXPECT_TRUE(test::is_documented("603 [8] " + request)) << request;
    const std::string reply = answer(request);
    EXPECT_TRUE(test::is_documented("583 [8] " + reply)) << reply;
    return reply;
  }
  /// A segment of a block download with seven equal bytes.
  std::string segment(unsigned head, unsigned byte) {
    CanFrame request{0x603, 8, {static_cast<std::uint8_t>(head)}};
    std::fill(request.data.begin() + 1, request.data.end(), static_cast<std::uint8_t>(byte));
    const std::optional<CanFrame> reply = server.receive(now, request);
    return reply ? text(*reply).substr(8) : "";
  }
  std::string next_segment() { return server.has_segment() ? text(server.next_segment(now)).substr(8) : ""; }
  std::string after(Microseconds time) {
    now += time;
    const std::optional<CanFrame> frame = server.poll(now);
    return frame ? text(*frame).substr(8) : "";
  }
  [[nodiscard]] std::string stored(Address address) {
    const test::DeviceMemory::Bytes& bytes = device.long_values[test::DeviceMemory::key(address)];
    return {bytes.begin(), bytes.end()};
  }

  test::DeviceMemory device;
  SdoServer server{3, device};
  Microseconds now = 5'000;
};

// Segmented transfers.

TEST_F(SdoFrames, AStringIsReadInSegments) {
  EXPECT_EQ(documented_answer("40 08 10 00 00 00 00 00"), "41 08 10 00 13 00 00 00") << "19 bytes";
  EXPECT_EQ(documented_answer("60 00 00 00 00 00 00 00"), "00 50 72 6F 6C 65 67 20") << "Proleg_";
  EXPECT_EQ(documented_answer("70 00 00 00 00 00 00 00"), "10 6A 6F 69 6E 74 20 6D") << "joint m";
  EXPECT_EQ(documented_answer("60 00 00 00 00 00 00 00"), "05 6F 64 75 6C 65 00 00")
      << "odule, two bytes unused, no more";
  EXPECT_EQ(answer("70 00 00 00 00 00 00 00"), "80 00 00 00 01 00 04 05") << "the transfer is over";
}

TEST_F(SdoFrames, AStringOfFourBytesIsReadAtOnce) {
  device.set_text({0x1008, 0}, "abc");
  EXPECT_EQ(answer("40 08 10 00 00 00 00 00"), "47 08 10 00 61 62 63 00");
  device.set_text({0x1008, 0}, "abcd");
  EXPECT_EQ(answer("40 08 10 00 00 00 00 00"), "43 08 10 00 61 62 63 64");
  device.set_text({0x1008, 0}, "");
  EXPECT_EQ(answer("40 08 10 00 00 00 00 00"), "41 08 10 00 00 00 00 00");
  EXPECT_EQ(answer("60 00 00 00 00 00 00 00"), "0F 00 00 00 00 00 00 00");
}

TEST_F(SdoFrames, AStringIsWrittenInSegments) {
  EXPECT_EQ(answer("21 00 2F 00 09 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("00 41 42 43 44 45 46 47"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(short_text), "") << "not before the end";
  EXPECT_EQ(answer("1B 48 49 00 00 00 00 00"), "30 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(short_text), "ABCDEFGHI");
}

TEST_F(SdoFrames, AStringOfUnknownSizeIsWrittenInSegments) {
  EXPECT_EQ(answer("20 00 2F 00 00 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("0B 41 42 00 00 00 00 00"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(short_text), "AB");
  EXPECT_EQ(answer("27 00 2F 00 43 44 45 00"), "60 00 2F 00 00 00 00 00") << "expedited, three bytes";
  EXPECT_EQ(stored(short_text), "CDE");
}

TEST_F(SdoFrames, ANumberMayTravelInSegmentsToo) {
  EXPECT_EQ(answer("21 06 10 00 04 00 00 00"), "60 06 10 00 00 00 00 00");
  EXPECT_EQ(answer("07 20 4E 00 00 00 00 00"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(device.value({0x1006, 0}), 20'000U);
  EXPECT_EQ(answer("20 17 10 00 00 00 00 00"), "60 17 10 00 00 00 00 00");
  EXPECT_EQ(answer("0D 64 00 00 00 00 00 00"), "80 17 10 00 13 00 07 06") << "one byte of two";
  EXPECT_EQ(answer("20 17 10 00 00 00 00 00"), "60 17 10 00 00 00 00 00");
  EXPECT_EQ(answer("09 64 00 00 00 00 00 00"), "80 17 10 00 12 00 07 06") << "three bytes of two";
  EXPECT_EQ(answer("21 17 10 00 04 00 00 00"), "80 17 10 00 10 00 07 06") << "four bytes announced";
  EXPECT_EQ(answer("21 06 10 00 04 00 00 00"), "60 06 10 00 00 00 00 00");
  EXPECT_EQ(answer("07 00 00 00 00 00 00 00"), "80 06 10 00 32 00 09 06") << "below the minimum";
  EXPECT_EQ(device.value({0x1006, 0}), 20'000U);
  EXPECT_EQ(device.writes, 1U);
}

TEST_F(SdoFrames, AToggleBitThatDoesNotAlternateEndsTheTransfer) {
  EXPECT_EQ(answer("40 08 10 00 00 00 00 00"), "41 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("70 00 00 00 00 00 00 00"), "80 08 10 00 00 00 03 05");
  EXPECT_EQ(answer("60 00 00 00 00 00 00 00"), "80 00 00 00 01 00 04 05") << "nothing is in progress";
  EXPECT_EQ(answer("21 00 2F 00 09 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("00 41 42 43 44 45 46 47"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(answer("00 41 42 43 44 45 46 47"), "80 00 2F 00 00 00 03 05");
  EXPECT_EQ(device.cancellations, 1U);
  EXPECT_EQ(stored(short_text), "");
}

TEST_F(SdoFrames, ALengthOutsideTheDeclarationIsRefused) {
  EXPECT_EQ(answer("21 00 2F 00 0B 00 00 00"), "80 00 2F 00 12 00 07 06") << "11 of 10 bytes announced";
  EXPECT_EQ(answer("21 00 2F 00 01 00 00 00"), "80 00 2F 00 13 00 07 06") << "1 of 2 bytes announced";
  EXPECT_EQ(answer("2F 00 2F 00 41 00 00 00"), "80 00 2F 00 13 00 07 06") << "expedited";
  EXPECT_EQ(answer("20 00 2F 00 00 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("00 41 42 43 44 45 46 47"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(answer("10 41 42 43 44 45 46 47"), "80 00 2F 00 12 00 07 06") << "14 bytes";
  EXPECT_EQ(answer("21 00 2F 00 09 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("01 41 42 43 44 45 46 47"), "80 00 2F 00 13 00 07 06") << "7 of the 9 announced";
  EXPECT_EQ(answer("21 00 2F 00 06 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("01 41 42 43 44 45 46 47"), "80 00 2F 00 12 00 07 06") << "7 of the 6 announced";
  EXPECT_EQ(device.writes, 0U);
  EXPECT_EQ(device.cancellations, 3U);
}

TEST_F(SdoFrames, AccessRightsHoldForEveryKindOfTransfer) {
  for (const std::string kind : {"20", "21", "22", "C0", "C2", "C6"}) {
    EXPECT_EQ(answer(kind + " 08 10 00 03 00 00 00"), "80 08 10 00 02 00 01 06") << "read-only, " << kind;
    EXPECT_EQ(answer(kind + " 00 21 01 04 00 00 00"), "80 00 21 01 00 00 01 06") << "for a PDO to write, " << kind;
    EXPECT_EQ(answer(kind + " 00 30 01 04 00 00 00"), "80 00 30 01 00 00 02 06") << "no such object, " << kind;
    EXPECT_EQ(answer(kind + " 18 10 09 04 00 00 00"), "80 18 10 09 11 00 09 06") << "no such sub-index, " << kind;
  }
  for (const std::string kind : {"40", "A0", "A4"}) {
    EXPECT_EQ(answer(kind + " 01 2F 00 7F 00 00 00"), "80 01 2F 00 01 00 01 06") << "write-only, " << kind;
    EXPECT_EQ(answer(kind + " 00 30 01 7F 00 00 00"), "80 00 30 01 00 00 02 06") << "no such object, " << kind;
    EXPECT_EQ(answer(kind + " 18 10 09 7F 00 00 00"), "80 18 10 09 11 00 09 06") << "no such sub-index, " << kind;
  }
  EXPECT_EQ(answer("23 01 2F 00 01 02 03 04"), "60 01 2F 00 00 00 00 00");
}

TEST_F(SdoFrames, TheDevicesRefusalIsHandedOn) {
  device.refusal = AbortCode::refused_by_state;
  for (const std::string request : {"40 08 10 00 00 00 00 00", "A4 08 10 00 7F 00 00 00"}) {
    EXPECT_EQ(answer(request), "80 08 10 00 22 00 00 08");
  }
  for (const std::string request : {"21 50 1F 01 08 00 00 00", "C6 50 1F 01 08 00 00 00"}) {
    EXPECT_EQ(answer(request), "80 50 1F 01 22 00 00 08");
  }
  device.refusal = AbortCode::none;
  device.fails_at = 7;
  EXPECT_EQ(answer("21 50 1F 01 08 00 00 00"), "60 50 1F 01 00 00 00 00");
  EXPECT_EQ(answer("00 01 02 03 04 05 06 07"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(answer("1D 08 00 00 00 00 00 00"), "80 50 1F 01 00 00 06 06") << "hardware error";
  EXPECT_EQ(device.cancellations, 1U);
  EXPECT_EQ(answer("40 08 10 00 00 00 00 00"), "41 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("60 00 00 00 00 00 00 00"), "00 50 72 6F 6C 65 67 20");
  EXPECT_EQ(answer("70 00 00 00 00 00 00 00"), "80 08 10 00 00 00 06 06");
  device.fails_at = 100;
  device.close_refusal = AbortCode::refused_by_application;
  EXPECT_EQ(answer("21 50 1F 01 01 00 00 00"), "60 50 1F 01 00 00 00 00");
  EXPECT_EQ(answer("0D 08 00 00 00 00 00 00"), "80 50 1F 01 20 00 00 08");
  EXPECT_EQ(device.cancellations, 2U);
  EXPECT_EQ(stored(domain), "");
}

// Block download.

TEST(BlockCrc, IsThatOfTheStandard) {
  BlockCrc crc;
  const std::string_view digits = "123456789";
  for (const char digit : digits) {
    const auto byte = static_cast<std::uint8_t>(digit);
    crc.add({&byte, 1});
  }
  EXPECT_EQ(crc.value(), 0x31C3) << "CiA 301, 7.2.4.3.16: check of the implementation";
}

TEST_F(SdoFrames, ADomainIsWrittenAsABlock) {
  EXPECT_EQ(answer("C6 50 1F 01 09 00 00 00"), "A4 50 1F 01 7F 00 00 00") << "127 segments";
  EXPECT_EQ(answer("01 31 32 33 34 35 36 37"), "");
  EXPECT_EQ(answer("82 38 39 00 00 00 00 00"), "A2 02 7F 00 00 00 00 00") << "two segments, the last one";
  EXPECT_EQ(stored(domain), "") << "not before the end";
  EXPECT_EQ(answer("D5 C3 31 00 00 00 00 00"), "A1 00 00 00 00 00 00 00") << "five bytes unused, the checksum";
  EXPECT_EQ(stored(domain), "123456789");
  EXPECT_EQ(answer("D5 C3 31 00 00 00 00 00"), "A1 00 00 00 00 00 00 00") << "the answer was lost";
  EXPECT_EQ(device.writes, 1U);
}

TEST_F(SdoFrames, TheSizeAndTheChecksumOfABlockAreOptional) {
  EXPECT_EQ(answer("C0 50 1F 01 00 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("81 41 42 43 00 00 00 00"), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(answer("D1 FF FF 00 00 00 00 00"), "A1 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(domain), "ABC");
  EXPECT_EQ(answer("C2 50 1F 01 00 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("81 00 00 00 00 00 00 00"), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(answer("DD 00 00 00 00 00 00 00"), "A1 00 00 00 00 00 00 00") << "no byte";
  EXPECT_EQ(stored(domain), "");
}

TEST_F(SdoFrames, ANumberMayTravelAsABlock) {
  EXPECT_EQ(answer("C6 06 10 00 04 00 00 00"), "A4 06 10 00 7F 00 00 00");
  EXPECT_EQ(answer("81 20 4E 00 00 00 00 00"), "A2 01 7F 00 00 00 00 00");
  BlockCrc crc;
  constexpr std::array<std::uint8_t, 4> bytes{0x20, 0x4E, 0, 0};
  crc.add(bytes);
  CanFrame end = frame("603 [8] CD 00 00 00 00 00 00 00");
  end.data[1] = static_cast<std::uint8_t>(crc.value());
  end.data[2] = static_cast<std::uint8_t>(crc.value() >> 8U);
  EXPECT_EQ(text(*server.receive(now, end)), "583 [8] A1 00 00 00 00 00 00 00");
  EXPECT_EQ(device.value({0x1006, 0}), 20'000U);
}

TEST_F(SdoFrames, AWrongChecksumOrLengthOfABlockChangesNothing) {
  EXPECT_EQ(answer("C6 50 1F 01 09 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("01 31 32 33 34 35 36 37"), "");
  EXPECT_EQ(answer("82 38 39 00 00 00 00 00"), "A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(answer("D5 C3 32 00 00 00 00 00"), "80 50 1F 01 04 00 04 05");
  EXPECT_EQ(answer("C2 50 1F 01 09 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("81 31 32 33 34 35 36 37"), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(answer("C1 00 00 00 00 00 00 00"), "80 50 1F 01 13 00 07 06") << "7 of 9";
  EXPECT_EQ(answer("C2 50 1F 01 06 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("81 31 32 33 34 35 36 37"), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(answer("C1 00 00 00 00 00 00 00"), "80 50 1F 01 12 00 07 06") << "7 of 6";
  EXPECT_EQ(device.cancellations, 3U);
  EXPECT_EQ(device.writes, 0U);
}

TEST_F(SdoFrames, AfterALostSegmentTheClientSendsWhatFollowsTheAcknowledgedOne) {
  EXPECT_EQ(answer("C2 50 1F 01 1C 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(segment(1, 'a'), "");
  EXPECT_EQ(segment(3, 'c'), "") << "the second is lost";
  EXPECT_EQ(segment(0x84, 'd'), "A2 01 7F 00 00 00 00 00") << "the first is there";
  EXPECT_EQ(segment(1, 'b'), "");
  EXPECT_EQ(segment(1, 'x'), "") << "a copy";
  EXPECT_EQ(segment(2, 'c'), "");
  EXPECT_EQ(segment(0x83, 'd'), "A2 03 7F 00 00 00 00 00");
  EXPECT_EQ(answer("C1 00 00 00 00 00 00 00"), "A1 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(domain), "aaaaaaabbbbbbbcccccccddddddd");
}

TEST_F(SdoFrames, AfterTheFirstLostSegmentTheWholeSubBlockIsRepeated) {
  EXPECT_EQ(answer("C2 50 1F 01 0E 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(segment(0x82, 'b'), "A2 00 7F 00 00 00 00 00");
  EXPECT_EQ(segment(1, 'a'), "");
  EXPECT_EQ(segment(0x82, 'b'), "A2 02 7F 00 00 00 00 00");
}

TEST_F(SdoFrames, AFullSubBlockIsAcknowledgedAtItsEnd) {
  EXPECT_EQ(answer("C0 50 1F 01 00 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  for (unsigned i = 1; i <= 126; ++i) {
    ASSERT_EQ(segment(i, i), "");
  }
  EXPECT_EQ(segment(127, 127), "A2 7F 7F 00 00 00 00 00");
  EXPECT_EQ(device.written.size(), 126U * 7U) << "the last segment is held: its length may come with the end";
  EXPECT_EQ(segment(0x81, 1), "A2 01 7F 00 00 00 00 00");
}

TEST_F(SdoFrames, ASequenceNumberOfZeroEndsTheBlock) {
  EXPECT_EQ(answer("C0 50 1F 01 00 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(segment(1, 'a'), "");
  EXPECT_EQ(segment(0, 'b'), "80 50 1F 01 03 00 04 05");
  EXPECT_EQ(device.cancellations, 1U);
}

TEST_F(SdoFrames, AnAbortOfABlockDownloadWaitsForTheEndOfTheSubBlock) {
  // A segment that comes after an abort would be a request: 0x23 is a download.
  device.fails_at = 7;
  EXPECT_EQ(answer("C0 50 1F 01 00 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(segment(1, 'a'), "");
  EXPECT_EQ(segment(2, 'b'), "");
  EXPECT_EQ(segment(3, 'c'), "") << "now the device has failed";
  for (unsigned i = 4; i <= 0x23; ++i) {
    EXPECT_EQ(segment(i, 0x20), "");
  }
  EXPECT_EQ(segment(0xA4, 'd'), "80 50 1F 01 00 00 06 06");
  EXPECT_EQ(device.cancellations, 1U);
}

// Block upload.

TEST_F(SdoFrames, AStringIsReadAsABlock) {
  EXPECT_EQ(answer("A4 08 10 00 02 00 00 00"), "C6 08 10 00 13 00 00 00") << "19 bytes, with checksum";
  EXPECT_FALSE(server.has_segment());
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "01 50 72 6F 6C 65 67 20");
  EXPECT_EQ(next_segment(), "02 6A 6F 69 6E 74 20 6D");
  EXPECT_EQ(next_segment(), "") << "a sub-block has two segments";
  EXPECT_EQ(answer("A2 02 7F 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "81 6F 64 75 6C 65 00 00");
  EXPECT_EQ(next_segment(), "");
  // Python: binascii.crc_hqx(b"Proleg joint module", 0)
  EXPECT_EQ(answer("A2 01 7F 00 00 00 00 00"), "C9 48 3E 00 00 00 00 00") << "two bytes unused";
  EXPECT_EQ(answer("A1 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(server.next_deadline(), never);
}

TEST_F(SdoFrames, ABlockUploadWithoutChecksumHasNone) {
  EXPECT_EQ(answer("A0 08 10 00 7F 00 00 00"), "C6 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  while (!next_segment().empty()) {
  }
  EXPECT_EQ(answer("A2 03 7F 00 00 00 00 00"), "C9 00 00 00 00 00 00 00");
}

TEST_F(SdoFrames, AnEmptyValueAndANumberCanBeReadAsBlocks) {
  device.set_text({0x1008, 0}, "");
  EXPECT_EQ(answer("A4 08 10 00 7F 00 00 00"), "41 08 10 00 00 00 00 00") << "not more than the threshold: 0 bytes";
  EXPECT_EQ(answer("A4 00 10 00 7F 00 00 00"), "C6 00 10 00 04 00 00 00");
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "81 92 01 02 00 00 00 00");
  EXPECT_EQ(answer("A2 01 7F 00 00 00 00 00").substr(0, 2), "CD") << "three bytes unused";
}

TEST_F(SdoFrames, UpToTheThresholdTheServerSwitchesToTheOtherProtocol) {
  EXPECT_EQ(answer("A4 08 10 00 7F 12 00 00"), "C6 08 10 00 13 00 00 00") << "18 bytes";
  EXPECT_EQ(answer("A4 08 10 00 7F 13 00 00"), "41 08 10 00 13 00 00 00") << "19 bytes";
  EXPECT_EQ(answer("60 00 00 00 00 00 00 00"), "00 50 72 6F 6C 65 67 20");
  EXPECT_EQ(answer("A4 00 10 00 7F 15 00 00"), "43 00 10 00 92 01 02 00") << "expedited";
}

TEST_F(SdoFrames, SegmentsAfterTheAcknowledgedOneAreSentAgain) {
  EXPECT_EQ(answer("A4 08 10 00 7F 00 00 00"), "C6 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "01 50 72 6F 6C 65 67 20");
  EXPECT_EQ(next_segment(), "02 6A 6F 69 6E 74 20 6D");
  EXPECT_EQ(answer("A2 01 7F 00 00 00 00 00"), "") << "before the end of the sub-block";
  EXPECT_EQ(next_segment(), "01 6A 6F 69 6E 74 20 6D");
  EXPECT_EQ(next_segment(), "82 6F 64 75 6C 65 00 00");
  EXPECT_EQ(answer("A2 00 7F 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "01 6A 6F 69 6E 74 20 6D");
  EXPECT_EQ(next_segment(), "82 6F 64 75 6C 65 00 00");
  EXPECT_EQ(answer("A2 02 7F 00 00 00 00 00"), "C9 48 3E 00 00 00 00 00") << "the checksum counts each byte once";
  EXPECT_EQ(answer("A2 02 7F 00 00 00 00 00"), "C9 48 3E 00 00 00 00 00") << "the end was lost";
}

TEST_F(SdoFrames, BlockSizesAndSequenceNumbersOutOfRangeEndAnUpload) {
  EXPECT_EQ(answer("A4 08 10 00 00 00 00 00"), "80 08 10 00 02 00 04 05");
  EXPECT_EQ(answer("A4 08 10 00 80 00 00 00"), "80 08 10 00 02 00 04 05");
  for (const std::string size : {"00", "80", "FF"}) {
    EXPECT_EQ(answer("A4 08 10 00 7F 00 00 00"), "C6 08 10 00 13 00 00 00");
    EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
    EXPECT_EQ(next_segment(), "01 50 72 6F 6C 65 67 20");
    EXPECT_EQ(answer("A2 01 " + size + " 00 00 00 00 00"), "80 08 10 00 02 00 04 05");
    EXPECT_EQ(next_segment(), "");
  }
  EXPECT_EQ(answer("A4 08 10 00 7F 00 00 00"), "C6 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "01 50 72 6F 6C 65 67 20");
  EXPECT_EQ(answer("A2 02 7F 00 00 00 00 00"), "80 08 10 00 03 00 04 05") << "more than were sent";
}

TEST_F(SdoFrames, AFailureOfTheDeviceEndsABlockUpload) {
  device.fails_at = 7;
  EXPECT_EQ(answer("A4 08 10 00 7F 00 00 00"), "C6 08 10 00 13 00 00 00");
  EXPECT_EQ(answer("A3 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(next_segment(), "01 50 72 6F 6C 65 67 20");
  EXPECT_EQ(next_segment(), "80 08 10 00 00 00 06 06");
  EXPECT_EQ(next_segment(), "");
}

// Ends of transfers.

TEST_F(SdoFrames, ARequestOfAnotherTransferEndsTheOneInProgress) {
  EXPECT_EQ(answer("21 00 2F 00 09 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("00 41 42 43 44 45 46 47"), "20 00 00 00 00 00 00 00");
  EXPECT_EQ(answer("40 00 10 00 00 00 00 00"), "43 00 10 00 92 01 02 00");
  EXPECT_EQ(device.cancellations, 1U);
  EXPECT_EQ(answer("10 48 49 00 00 00 00 00"), "80 48 49 00 01 00 04 05");
  EXPECT_EQ(answer("21 00 2F 00 09 00 00 00"), "60 00 2F 00 00 00 00 00");
  EXPECT_EQ(answer("60 00 00 00 00 00 00 00"), "80 00 2F 00 01 00 04 05") << "a segment of an upload";
  EXPECT_EQ(device.cancellations, 2U);
}

TEST_F(SdoFrames, AnAbortOfTheClientEndsEveryKindOfTransferWithoutAnAnswer) {
  for (const std::string begin :
       {"21 50 1F 01 09 00 00 00", "C6 50 1F 01 09 00 00 00", "40 08 10 00 00 00 00 00", "A4 08 10 00 7F 00 00 00"}) {
    EXPECT_NE(answer(begin), "");
    EXPECT_NE(server.next_deadline(), never);
    EXPECT_EQ(answer("80 50 1F 01 00 00 00 08"), "");
    EXPECT_EQ(server.next_deadline(), never);
    EXPECT_EQ(after(10'000'000), "");
  }
  EXPECT_EQ(device.cancellations, 2U);
  EXPECT_EQ(device.writes, 0U);
}

TEST_F(SdoFrames, ATransferThatStopsInTheMiddleIsAborted) {
  for (const std::string begin : {"21 50 1F 01 09 00 00 00", "40 08 10 00 00 00 00 00", "A4 08 10 00 7F 00 00 00"}) {
    EXPECT_NE(answer(begin), "");
    EXPECT_EQ(server.next_deadline(), now + 1'000'000);
    EXPECT_EQ(after(999'999), "");
    EXPECT_EQ(after(1), "80 " + begin.substr(3, 8) + " 00 00 04 05");
    EXPECT_EQ(server.next_deadline(), never);
  }
  EXPECT_EQ(device.cancellations, 1U);
}

TEST_F(SdoFrames, ASilentClientOfABlockDownloadIsRemindedAndThenGivenUp) {
  EXPECT_EQ(answer("C2 50 1F 01 09 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(after(200'000), "A4 50 1F 01 7F 00 00 00") << "the first answer may be lost";
  EXPECT_EQ(answer("01 31 32 33 34 35 36 37"), "");
  EXPECT_EQ(after(200'000), "A2 01 7F 00 00 00 00 00") << "the last segment may be lost";
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(after(200'000), "A2 01 7F 00 00 00 00 00") << "the acknowledgement may be lost";
  }
  EXPECT_EQ(after(200'000), "80 50 1F 01 00 00 04 05");
  EXPECT_EQ(device.cancellations, 1U);
}

TEST_F(SdoFrames, FramesThatAreNotTheNextSegmentDoNotKeepABlockDownloadForEver) {
  EXPECT_EQ(answer("C2 50 1F 01 09 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  // The acknowledgements of another client's upload: segment 34, the last one.
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(answer("A2 00 7F 00 00 00 00 00"), "A2 00 7F 00 00 00 00 00");
  }
  EXPECT_EQ(answer("A2 00 7F 00 00 00 00 00"), "80 50 1F 01 00 00 04 05");
  EXPECT_EQ(device.cancellations, 1U);
}

TEST_F(SdoFrames, TheEndOfABlockDownloadIsAwaitedInTheSameWay) {
  EXPECT_EQ(answer("C2 50 1F 01 02 00 00 00"), "A4 50 1F 01 7F 00 00 00");
  EXPECT_EQ(answer("81 31 32 00 00 00 00 00"), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(after(200'000), "A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(answer("D5 00 00 00 00 00 00 00"), "A1 00 00 00 00 00 00 00");
  EXPECT_EQ(stored(domain), "12");
}

}  // namespace
}  // namespace proleg::canopen
