// The formats of programs for chips are known by their first bytes.

#include "host/flash/image_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace proleg::host {
namespace {

ProgramFormat format_of(const std::string& text) {
  return find_format(std::vector<std::uint8_t>(text.begin(), text.end()));
}

ProgramFormat format_of_words(const std::vector<std::uint32_t>& words) {
  std::string text;
  for (const std::uint32_t word : words) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      text += static_cast<char>(word >> shift & 0xFFU);
    }
  }
  return format_of(text);
}

TEST(ProgramFormat, IsKnownByTheFirstBytes) {
  EXPECT_EQ(format_of("PIMG\x01"), ProgramFormat::image);
  EXPECT_EQ(format_of("\x7F"
                      "ELF\x01\x01\x01"),
            ProgramFormat::elf);
  // The first records of objcopy -O ihex, and the end of such a file.
  EXPECT_EQ(format_of(":020000040802F0\r\n"), ProgramFormat::intel_hex);
  EXPECT_EQ(format_of(":00000001FF\n"), ProgramFormat::intel_hex);
  EXPECT_EQ(format_of("S0030000FC\r\n"), ProgramFormat::s_records);
  EXPECT_EQ(format_of("S31508020000000002200102020841010208410102080A\n"), ProgramFormat::s_records);
  EXPECT_EQ(format_of_words({0x2000'0800, 0x0802'0401, 0x0802'0411, 0x0802'0413}), ProgramFormat::raw);
  EXPECT_EQ(format_of_words({0x2002'0000, 0x0000'0101, 0x0000'0103, 0x0000'0103, 0}), ProgramFormat::raw);
}

TEST(ProgramFormat, IsNotGuessed) {
  EXPECT_EQ(format_of(""), ProgramFormat::unknown);
  EXPECT_EQ(format_of("PIM"), ProgramFormat::unknown);
  EXPECT_EQ(format_of("\x7F"
                      "EL"),
            ProgramFormat::unknown);
  EXPECT_EQ(format_of(": a remark of a person"), ProgramFormat::unknown);
  EXPECT_EQ(format_of(":02000004"), ProgramFormat::unknown);
  EXPECT_EQ(format_of("Some text"), ProgramFormat::unknown);
  EXPECT_EQ(format_of("S0: some text"), ProgramFormat::unknown);
  EXPECT_EQ(format_of(std::string(64, '\0')), ProgramFormat::unknown);
  EXPECT_EQ(format_of(std::string(64, '\xFF')), ProgramFormat::unknown) << "erased flash";
  EXPECT_EQ(format_of_words({0x2000'0800, 0x0802'0401, 0x0802'0411}), ProgramFormat::unknown) << "too short";
  EXPECT_EQ(format_of_words({0x2000'0801, 0x0802'0401, 0x0802'0411, 0x0802'0413}), ProgramFormat::unknown);
  EXPECT_EQ(format_of_words({0x0800'0800, 0x0802'0401, 0x0802'0411, 0x0802'0413}), ProgramFormat::unknown);
  EXPECT_EQ(format_of_words({0x2000'0800, 0x0802'0400, 0x0802'0411, 0x0802'0413}), ProgramFormat::unknown);
  EXPECT_EQ(format_of_words({0x2000'0800, 0x0802'0401, 0x2000'0411, 0x0802'0413}), ProgramFormat::unknown);
}

}  // namespace
}  // namespace proleg::host
