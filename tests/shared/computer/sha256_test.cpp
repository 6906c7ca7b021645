#include "shared/computer/hash/sha256.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include "shared/fixed/random.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

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

/// Appends the bytes of a text, in their order. Its size must be a multiple of four.
void append(ValueHash& hash, const std::string& text) {
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t bits = 0;
    for (std::size_t byte = 0; byte < 4; ++byte) {
      bits |= std::uint32_t{static_cast<unsigned char>(text[i + byte])} << (8 * byte);
    }
    hash.append(static_cast<std::int32_t>(bits));
  }
}

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return output;
  }
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    output += static_cast<char>(c);
  }
  pclose(pipe);
  return output;
}

// FIPS 180-2, appendix B, and NIST's example of the empty message.

TEST(ValueHash, OfNothingIsThatOfTheEmptyMessage) {
  EXPECT_EQ(ValueHash().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(ValueHash, GivesTheFipsExampleOfTwoBlocks) {
  ValueHash hash;
  append(hash, "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq");
  EXPECT_EQ(hash.hex(), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(ValueHash, GivesTheFipsExampleOfAMillionLetters) {
  ValueHash hash;
  append(hash, std::string(1'000'000, 'a'));
  EXPECT_EQ(hash.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(ValueHash, MayBeReadBetweenValues) {
  ValueHash read;
  ValueHash unread;
  for (std::int32_t i = 0; i < 40; ++i) {
    read.append(i);
    unread.append(i);
    EXPECT_EQ(read.hex().size(), 64U);
  }
  EXPECT_EQ(read.hex(), unread.hex());
}

TEST(ValueHash, DependsOnOrderAndSign) {
  const auto hash_of = [](std::initializer_list<std::int32_t> values) {
    ValueHash hash;
    for (const std::int32_t value : values) {
      hash.append(value);
    }
    return hash.hex();
  };
  EXPECT_NE(hash_of({1, 2}), hash_of({2, 1}));
  EXPECT_NE(hash_of({1}), hash_of({-1}));
  EXPECT_NE(hash_of({0}), hash_of({0, 0}));
}

TEST(ValueHash, AgreesWithSha256sumOnLittleEndianBytes) {
  const TemporaryFolder folder;
  const std::string path = (folder / "setpoints.bin").string();
  Pcg32 random(2, 0);
  ValueHash hash;
  {
    std::ofstream file(path, std::ios::binary);
    for (int i = 0; i < 1001; ++i) {
      const std::uint32_t bits = random.next();
      hash.append(static_cast<std::int32_t>(bits));
      for (unsigned byte = 0; byte < 4; ++byte) {
        file.put(static_cast<char>(static_cast<unsigned char>(bits >> (8 * byte))));
      }
    }
  }
  EXPECT_EQ(output_of("sha256sum < '" + path + "'"), hash.hex() + "  -\n");
}

}  // namespace
}  // namespace proleg
