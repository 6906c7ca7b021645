#include "shared/fixed/crc32.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

namespace proleg {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// The checksum by its definition: the remainder of a division of polynomials, bit by bit, not reflected. Bits of bytes
/// and of the result are reversed instead.
std::uint32_t by_definition(const std::vector<std::uint8_t>& bytes) {
  const auto turned = [](std::uint32_t value, unsigned bits) {
    std::uint32_t result = 0;
    for (unsigned i = 0; i < bits; ++i) {
      result |= ((value >> i) & 1U) << (bits - 1 - i);
    }
    return result;
  };
  std::uint32_t remainder = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    remainder ^= turned(byte, 8) << 24U;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder << 1U) ^ ((remainder & 0x80000000U) != 0 ? 0x04C11DB7U : 0U);
    }
  }
  return ~turned(remainder, 32);
}

TEST(Crc32, HasTheKnownCheckValue) {
  EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}

// Values of zlib's crc32() for these buffers.
TEST(Crc32, AgreesWithZlib) {
  struct Case {
    unsigned size;
    unsigned seed;
    std::uint32_t crc;
  };
  constexpr Case cases[] = {
      {0, 0, 0x00000000},    {1, 0, 0xD202EF8D},    {1, 5, 0xB5DFA541},     {2, 1, 0xCE31840D},
      {3, 2, 0xA4A6B5DD},    {4, 3, 0x5BA0E798},    {7, 4, 0x7A47E4EB},     {8, 5, 0x8479DEB9},
      {15, 6, 0xAEFE197C},   {16, 7, 0x9AECCD8C},   {64, 8, 0xEB30D4B8},    {119, 9, 0x20A48293},
      {255, 10, 0x5EB5F674}, {256, 11, 0x86B927A8}, {1000, 12, 0xAC37D670}, {4096, 13, 0x53578F25},
  };
  for (const Case& c : cases) {
    std::vector<std::uint8_t> bytes;
    for (unsigned i = 0; i < c.size; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(i * i * 7 + c.seed * 31 + i * 3 + (i >> 3U) * c.seed));
    }
    EXPECT_EQ(crc32(bytes), c.crc) << c.size << " bytes";
  }
}

TEST(Crc32, IsTheRemainderOfTheDivisionHoweverTheBytesArePortioned) {
  constexpr std::uint32_t seed = 20;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 500; ++run) {
    std::vector<std::uint8_t> bytes(random() % 200);
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(random());
    }
    Crc32 crc;
    std::span<const std::uint8_t> rest = bytes;
    while (!rest.empty()) {
      const std::size_t portion = 1 + random() % rest.size();
      crc.add(rest.first(portion));
      rest = rest.subspan(portion);
    }
    ASSERT_EQ(crc.value(), by_definition(bytes)) << "run " << run;
    ASSERT_EQ(crc32(bytes), crc.value());
  }
}

}  // namespace
}  // namespace proleg
