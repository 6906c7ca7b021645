#include "shared/image/sha512.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/hash/sha256.hpp"

namespace proleg::image {
namespace {

constexpr std::uint32_t sha512_seed = 1;

std::string sha512_digits(const std::vector<std::uint8_t>& bytes) { return hexadecimal_digits(sha512(bytes)); }

std::vector<std::uint8_t> characters_of(std::string_view text) { return {text.begin(), text.end()}; }

/// The hash by OpenSSL.
std::string openssl_digits(const std::vector<std::uint8_t>& bytes) {
  Sha512::Hash hash{};
  EXPECT_EQ(EVP_Digest(bytes.data(), bytes.size(), hash.data(), nullptr, EVP_sha512(), nullptr), 1);
  return hexadecimal_digits(hash);
}

// NIST publishes the examples of one and two blocks with FIPS 180-4. The last message is from FIPS 180-2, section C.3.
TEST(ImageSha512, HasThePublishedValues) {
  EXPECT_EQ(sha512_digits(characters_of("abc")),
            "ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a"
            "2192992a274fc1a836ba3c23a3feebbd454d4423643ce80e2a9ac94fa54ca49f");
  EXPECT_EQ(sha512_digits(characters_of("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmn"
                                        "hijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu")),
            "8e959b75dae313da8cf4f72814fc143f8f7779c6eb9f7fa17299aeadb6889018"
            "501d289e4900f7e4331b99dec4b5433ac7d329eeb6dd26545e96e55b874be909");
  EXPECT_EQ(sha512_digits(std::vector<std::uint8_t>(1'000'000, 'a')),
            "e718483d0ce769644e2e42c7bc15b4638e1f98b13b2044285632a803afa973eb"
            "de0ff244877ea60a4cb0432ce577c31beb009c5c2c49aa2e4eadb217ad8cc09b");
}

TEST(ImageSha512, IsOpensslsForAllLengthsOfAFewBlocks) {
  std::mt19937 random(sha512_seed);
  std::vector<std::uint8_t> bytes;
  for (int length = 0; length <= 600; ++length) {
    ASSERT_EQ(sha512_digits(bytes), openssl_digits(bytes)) << length << " bytes, seed " << sha512_seed;
    bytes.push_back(static_cast<std::uint8_t>(random()));
  }
}

TEST(ImageSha512, IsTheSameInPiecesOfAnySize) {
  std::mt19937 random(sha512_seed);
  std::vector<std::uint8_t> bytes(1'000'003);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  Sha512 pieces;
  std::span<const std::uint8_t> rest = bytes;
  while (!rest.empty()) {
    const std::size_t size = std::min<std::size_t>(rest.size(), random() % 400);
    pieces.add(rest.first(size));
    rest = rest.subspan(size);
  }
  EXPECT_EQ(hexadecimal_digits(pieces.finish()), openssl_digits(bytes)) << "seed " << sha512_seed;
}

}  // namespace
}  // namespace proleg::image
