#include "shared/computer/hash/sha256.hpp"

#include <gtest/gtest.h>

#include <array>

namespace proleg {
namespace {

// FIPS 180-2, appendix B, and NIST's example of the empty message.

TEST(Sha256, GivesTheFipsExamples) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, HashesBytesOfValueZeroToo) { EXPECT_NE(sha256_hex(std::string_view("a\0b", 3)), sha256_hex("a")); }

TEST(HexadecimalDigits, AreTwoForEachByte) {
  EXPECT_EQ(hexadecimal_digits(std::array<unsigned char, 3>{0x00, 0x0F, 0xA5}), "000fa5");
}

}  // namespace
}  // namespace proleg
