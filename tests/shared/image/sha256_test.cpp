#include "shared/image/sha256.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "shared/computer/hash/sha256.hpp"

namespace proleg::image {
namespace {

std::string digits_of(const std::vector<std::uint8_t>& bytes) { return hexadecimal_digits(sha256(bytes)); }

/// The hash by libsodium.
std::string expected_digits(const std::vector<std::uint8_t>& bytes) {
  return sha256_hex(std::string(bytes.begin(), bytes.end()));
}

TEST(ImageSha256, IsLibsodiumsForAllLengthsAroundAFewBlocks) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes;
  for (int length = 0; length <= 300; ++length) {
    ASSERT_EQ(digits_of(bytes), expected_digits(bytes)) << length << " bytes";
    bytes.push_back(static_cast<std::uint8_t>(random()));
  }
}

TEST(ImageSha256, IsTheSameInPiecesOfAnySize) {
  std::mt19937 random(2);
  std::vector<std::uint8_t> bytes(65'536);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  Sha256 pieces;
  std::span<const std::uint8_t> rest = bytes;
  while (!rest.empty()) {
    const std::size_t size = std::min<std::size_t>(rest.size(), random() % 200);
    pieces.add(rest.first(size));
    rest = rest.subspan(size);
  }
  EXPECT_EQ(hexadecimal_digits(pieces.finish()), expected_digits(bytes));
}

}  // namespace
}  // namespace proleg::image
