#include "shared/can/slcan.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace proleg {
namespace {

using namespace std::string_literals;

// Examples of Linux, drivers/net/can/slcan/slcan-core.c, and of LAWICEL's manual of the CANUSB.
TEST(SlcanFrames, AreThoseOfThePublishedExamples) {
  const std::vector<std::pair<std::string, SlcanFrame>> examples{
      {"t1230", {0x123, false, false, 0, {}, {}}},
      {"t4563112233", {0x456, false, false, 3, {0x11, 0x22, 0x33}, {}}},
      {"T12ABCDEF2AA55", {0x12ABCDEF, true, false, 2, {0xAA, 0x55}, {}}},
      {"r1230", {0x123, false, true, 0, {}, {}}},
      {"t10021133", {0x100, false, false, 2, {0x11, 0x33}, {}}},
      {"t1002113300A5", {0x100, false, false, 2, {0x11, 0x33}, 0x00A5}},
      {"R000001008EA5F", {0x100, true, true, 8, {}, 59'999}},
  };
  for (const auto& [line, frame] : examples) {
    EXPECT_EQ(parse_slcan_frame(line), frame) << line;
    EXPECT_EQ(format_slcan_frame(frame).view(), line);
  }
}

TEST(SlcanFrames, MayHaveDigitsOfEitherCase) {
  EXPECT_EQ(parse_slcan_frame("t7fF1aB"), (SlcanFrame{0x7FF, false, false, 1, {0xAB}, {}}));
}

TEST(SlcanFrames, OfProlegAreStandardDataFrames) {
  EXPECT_TRUE(parse_slcan_frame("t1230")->is_for_protocol());
  for (const char* line : {"T000001230", "r1230", "R000001230"}) {
    EXPECT_FALSE(parse_slcan_frame(line)->is_for_protocol()) << line;
  }
  EXPECT_EQ(parse_slcan_frame("t60340102030A")->can_frame(), (CanFrame{0x603, 4, {1, 2, 3, 10}}));
  EXPECT_EQ(slcan_frame({0x603, 2, {1, 2}}, 7), (SlcanFrame{0x603, false, false, 2, {1, 2}, 7}));
}

TEST(SlcanFrames, AreRejectedIfADigitIsMissingSuperfluousOrWrong) {
  for (const std::string& line :
       {""s,           "t"s,        "t123"s,       "t12"s,   "t1239"s, "t8000"s,  "t1231"s,  "t12311"s,  "t123111122"s,
        "t1230EA60"s,  "t1230123"s, "t123012345"s, "tG230"s, "t12 0"s, "t123a"s,  "t-230"s,  "t+230"s,   "t0x10"s,
        "T200000000"s, "T1230"s,    "r12311"s,     "x1230"s, "1230"s,  " t1230"s, "t1230 "s, "t1230\0"s, "\0"s}) {
    EXPECT_EQ(parse_slcan_frame(line), std::nullopt) << testing::PrintToString(line);
  }
}

// Examples of Linux, drivers/net/can/slcan/slcan-core.c.
TEST(SlcanStatus, IsThatOfThePublishedExamples) {
  EXPECT_EQ(parse_slcan_status("sb256256"), (CanStatus{CanState::bus_off, 256, 256}));
  EXPECT_EQ(parse_slcan_status("sa057033"), (CanStatus{CanState::error_active, 57, 33}));
  EXPECT_EQ(format_slcan_status({CanState::error_active, 57, 33}).view(), "sa057033");
  EXPECT_EQ(format_slcan_status({CanState::error_warning, 0, 96}).view(), "sw000096");
  EXPECT_EQ(format_slcan_status({CanState::error_passive, 128, 1'000}).view(), "sp128999");
  for (const char* line : {"", "s", "sx000000", "sa05703", "sa0570333", "sa05A033", "xa057033"}) {
    EXPECT_EQ(parse_slcan_status(line), std::nullopt) << line;
  }
}

// Examples of Linux, drivers/net/can/slcan/slcan-core.c.
TEST(SlcanErrors, AreThoseOfThePublishedExamples) {
  CanErrors errors;
  EXPECT_EQ(format_slcan_errors(errors).view(), "e0");
  errors.add(CanErrorKind::acknowledgement);
  EXPECT_EQ(parse_slcan_errors("e1a"), errors);
  EXPECT_EQ(format_slcan_errors(errors).view(), "e1a");
  CanErrors more;
  for (const CanErrorKind kind : {CanErrorKind::transmit_overrun, CanErrorKind::bit_dominant, CanErrorKind::crc}) {
    more.add(kind);
  }
  EXPECT_EQ(parse_slcan_errors("e3bcO"), more);
  EXPECT_EQ(format_slcan_errors(more).view(), "e3bcO");
  for (const char* line : {"", "e", "e1", "e2a", "e1aa", "e1x", "e9aaaaaaaaa", "x1a"}) {
    EXPECT_EQ(parse_slcan_errors(line), std::nullopt) << line;
  }
}

/// The lines that characters make; "<BEL>" and "<long>" stand for the other events.
std::vector<std::string> lines_of(std::string_view characters) {
  SlcanLineReader reader;
  std::vector<std::string> lines;
  for (const char character : characters) {
    switch (reader.push(character)) {
      case SlcanLineReader::Event::none:
        break;
      case SlcanLineReader::Event::line:
        lines.emplace_back(reader.line());
        break;
      case SlcanLineReader::Event::rejected:
        lines.push_back(std::string(reader.line()) + "<BEL>");
        break;
      case SlcanLineReader::Event::too_long:
        lines.emplace_back("<long>");
        break;
    }
  }
  return lines;
}

TEST(SlcanLines, EndWithCrOrBel) {
  EXPECT_EQ(lines_of("t1230\r\r\a"
                     "ab\aO"),
            (std::vector<std::string>{"t1230", "", "<BEL>", "ab<BEL>"}));
}

TEST(SlcanLines, MayEndWithCrLf) { EXPECT_EQ(lines_of("C\r\nO\r\n\r\n"), (std::vector<std::string>{"C", "O", ""})); }

TEST(SlcanLines, ThatAreTooLongAreDroppedUpToTheirEnd) {
  const std::string longest(slcan_max_line, 'x');
  EXPECT_EQ(lines_of(longest + "\r" + longest + "x\rO\r" + std::string(1'000, 'y') + "\aC\r"),
            (std::vector<std::string>{longest, "<long>", "O", "<long>", "C"}));
}

}  // namespace
}  // namespace proleg
