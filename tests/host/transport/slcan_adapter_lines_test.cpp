#include "host/transport/slcan_adapter_lines.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace proleg::host {
namespace {

std::vector<std::string> lines_of(std::string_view characters, bool ends_after_z = false) {
  SlcanAdapterLines lines;
  if (ends_after_z) {
    lines.end_lines_after_z();
  }
  std::vector<std::string> found;
  for (const char character : characters) {
    const auto event = lines.push(character);
    if (event != SlcanAdapterLines::Event::none) {
      found.push_back(std::string(lines.line()) + (event == SlcanAdapterLines::Event::rejected ? " BEL" : ""));
    }
  }
  return found;
}

TEST(SlcanAdapterLines, EndWithCrOrLfOrBothOrBel) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of("\rz\rV1013\r"), (Lines{"", "z", "V1013"}));
  EXPECT_EQ(lines_of("\r\nz\r\nV1013\r\n"), (Lines{"", "z", "V1013"}));
  EXPECT_EQ(lines_of("z\nV1013\n"), (Lines{"z", "V1013"}));
  EXPECT_EQ(lines_of("z\n\rV1013\n\r"), (Lines{"z", "V1013"}));
  EXPECT_EQ(lines_of("\at12\a"), (Lines{" BEL", "t12 BEL"}));
}

TEST(SlcanAdapterLines, EndAfterZIfTheAdapterConfirmsSo) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of("zZt1230\rz\ar1230\r", true), (Lines{"z", "Z", "t1230", "z", " BEL", "r1230"}));
  EXPECT_EQ(lines_of("zzt1230\r"), (Lines{"zzt1230"}));
}

TEST(SlcanAdapterLines, OfFramesMayHaveMoreDigits) {
  // Time stamps: LAWICEL's manual of the CANUSB (0 to 0xEA5F). Others count 16 bits, or microseconds with 32 bits.
  for (const char* digits : {"", "EA5F", "EA60", "FFFF", "0001E240", "ffffffff", "0", "1EA60", "00001E240"}) {
    SlcanAdapterLines lines;
    for (unsigned i = 0; i < 2; ++i) {
      const auto frame = lines.read_frame(std::string("t6032AABB") + digits);
      ASSERT_TRUE(frame) << digits;
      EXPECT_EQ(frame->can_frame(), (CanFrame{0x603, 2, {0xAA, 0xBB}})) << digits;
    }
    EXPECT_EQ(lines.read_frame(std::string("T000001000") + digits), (SlcanFrame{0x100, true, false, 0, {}, {}}));
    EXPECT_EQ(lines.read_frame(std::string("r1238") + digits), (SlcanFrame{0x123, false, true, 8, {}, {}}));
  }
}

TEST(SlcanAdapterLines, OfFramesHaveNoOtherEnd) {
  SlcanAdapterLines lines;
  for (const char* line : {"", "t", "t603", "t6032AAB", "t6039", "t6032AABB12", "t6032AABB123", "t6032AABBEA60EA60E2",
                           "t6032AABB12G4", "t6032AABB-001", "z", "x1230"}) {
    EXPECT_FALSE(lines.read_frame(line)) << line;
  }
}

TEST(SlcanAdapterLines, OfAFrameThatHasLostItsLengthIsNoFrame) {
  // t60380102030405060708 without the 8: three bytes and nine digits.
  SlcanAdapterLines lines;
  EXPECT_TRUE(lines.read_frame("t60380302030405060708"));
  EXPECT_FALSE(lines.read_frame("t6033302030405060"));
  EXPECT_TRUE(lines.read_frame("t60380302030405060708"));
}

}  // namespace
}  // namespace proleg::host
