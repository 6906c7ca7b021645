#include "shared/computer/deflate/deflate.hpp"

#include <gtest/gtest.h>

namespace proleg {
namespace {

TEST(Base64, HasTheTestVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

// Other programs read the format: tests/tools/proleg/export_html_test.py and tests/host/page/data.
TEST(Deflate, HasTheHeaderAndTheChecksumOfRfc1950) {
  const std::string result = deflate("Wikipedia");
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(result.at(i)); };
  EXPECT_EQ((byte(0) * 256U + byte(1)) % 31U, 0U);
  EXPECT_EQ(byte(0) & 15U, 8U);
  // The Adler-32 of "Wikipedia", 0x11E60398, is the usual published example.
  const std::string checksum = result.substr(result.size() - 4);
  EXPECT_EQ(checksum, std::string("\x11\xE6\x03\x98", 4));
}

TEST(Deflate, ShortensWhatRepeats) { EXPECT_LT(deflate(std::string(100000, 'x')).size(), 200U); }

}  // namespace
}  // namespace proleg
