#include "shared/image/image_header.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::image {
namespace {

constexpr std::uint32_t body_address = 0x0802'0200;

std::vector<std::uint8_t> random_body(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> body(size);
  for (std::uint8_t& byte : body) {
    byte = static_cast<std::uint8_t>(random());
  }
  return body;
}

Header header_of(const std::vector<std::uint8_t>& body) {
  Header header;
  header.board_id = 1;
  header.lowest_revision = 2;
  header.highest_revision = 5;
  header.version = {1, 20, 300};
  header.protocol = 0x0100;
  header.core_fingerprint = 0x87932128;
  header.settings_schema = 2;
  header.has_changed_sources = true;
  header.address = body_address;
  header.commit.fill(0xC3);
  header.minimum_version = {1, 2, 258};
  header.next_key.fill(0x7E);
  describe_body(header, body);
  return header;
}

/// Gives bytes the CRC that belongs to them, as an attacker would do.
HeaderBytes with_right_crc(HeaderBytes bytes) {
  write_little_endian(bytes, 508, 4, crc32(std::span(bytes).first(508)));
  return bytes;
}

TEST(ImageHeader, IsReadAsItWasWritten) {
  const Header header = header_of(random_body(1'000, 1));
  const HeaderResult result = decode(encode(header));
  EXPECT_EQ(result.error, Error::none);
  EXPECT_EQ(result.header, header);
}

// The positions are those of the header's description, because other tools read the same bytes.
TEST(ImageHeader, HasItsValuesAtFixedPlaces) {
  const std::vector<std::uint8_t> body = random_body(400, 2);
  const HeaderBytes bytes = encode(header_of(body));
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "PIMG");
  EXPECT_EQ(read_little_endian(bytes, 4, 2), 1U);
  EXPECT_EQ(read_little_endian(bytes, 6, 2), 512U);
  EXPECT_EQ(read_little_endian(bytes, 8, 2), 1U);
  EXPECT_EQ(read_little_endian(bytes, 10, 2), 0x0502U);
  EXPECT_EQ(read_little_endian(bytes, 12, 2), 1U);
  EXPECT_EQ(read_little_endian(bytes, 14, 2), 20U);
  EXPECT_EQ(read_little_endian(bytes, 16, 2), 300U);
  EXPECT_EQ(read_little_endian(bytes, 18, 2), 0x0100U);
  EXPECT_EQ(read_little_endian(bytes, 20, 4), 0x87932128U);
  EXPECT_EQ(read_little_endian(bytes, 24, 2), 0x0102U);
  EXPECT_EQ(read_little_endian(bytes, 28, 4), body_address);
  EXPECT_EQ(read_little_endian(bytes, 32, 4), 400U);
  EXPECT_EQ(read_little_endian(bytes, 36, 4), crc32(body));
  EXPECT_EQ(read_little_endian(bytes, 40, 4), 0xC3C3C3C3U);
  EXPECT_TRUE(std::equal(bytes.begin() + 64, bytes.begin() + 96, sha256(body).begin()));
  EXPECT_EQ(read_little_endian(bytes, 160, 4), 0x0002'0001U);
  EXPECT_EQ(read_little_endian(bytes, 164, 4), 258U);
  EXPECT_EQ(read_little_endian(bytes, 168, 4), 0x7E7E'7E7EU);
  EXPECT_EQ(read_little_endian(bytes, 196, 4), 0x7E7E'7E7EU);
}

TEST(ImageHeader, IsRefusedWithAnyBitChanged) {
  const HeaderBytes bytes = encode(header_of(random_body(400, 3)));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      HeaderBytes changed = bytes;
      changed[i] ^= static_cast<std::uint8_t>(1U << bit);
      const Error expected = i < 4 ? Error::not_an_image : i < 8 ? Error::unknown_format : Error::damaged_header;
      ASSERT_EQ(decode(changed).error, expected) << "byte " << i << ", bit " << bit;
    }
  }
}

TEST(ImageHeader, IsRefusedWithAnyPartMissing) {
  const HeaderBytes bytes = encode(header_of(random_body(400, 4)));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_EQ(decode(std::span(bytes).first(size)).error, Error::too_short) << size;
  }
  // The header is written to erased flash, and the write is cut off at any word.
  for (std::size_t size = 0; size < bytes.size(); size += 4) {
    HeaderBytes cut = bytes;
    std::fill(cut.begin() + static_cast<std::ptrdiff_t>(size), cut.end(), std::uint8_t{0xFF});
    ASSERT_NE(decode(cut).error, Error::none) << size;
  }
}

TEST(ImageHeader, IsRefusedWithAnImpossibleValueAndTheRightChecksum) {
  const HeaderBytes bytes = encode(header_of(random_body(400, 5)));
  const struct {
    std::size_t at;
    std::size_t size;
    std::uint32_t value;
  } impossible[]{{10, 2, 0x0205},            // lowest revision above the highest
                 {25, 1, 2},                 // unknown flag
                 {26, 1, 1},                 // reserved
                 {27, 1, 1},                 //
                 {28, 4, body_address + 4},  // vectors must be aligned
                 {32, 4, 0},                 // no body
                 {32, 4, 401},               //
                 {166, 1, 1},                // reserved
                 {200, 1, 1},                //
                 {507, 1, 0x80}};
  for (const auto& change : impossible) {
    HeaderBytes changed = bytes;
    write_little_endian(changed, change.at, change.size, change.value);
    EXPECT_EQ(decode(with_right_crc(changed)).error, Error::impossible_value) << "byte " << change.at;
  }
}

TEST(ImageHeader, OfALaterFormatIsNotGuessed) {
  for (const std::size_t at : {4U, 6U}) {
    HeaderBytes bytes = encode(header_of(random_body(400, 6)));
    bytes[at] ^= 3U;
    EXPECT_EQ(decode(with_right_crc(bytes)).error, Error::unknown_format);
  }
}

TEST(ImageHeader, MayHaveASignature) {
  Header header = header_of(random_body(400, 7));
  header.key_id = 77;
  header.signature.fill(0x5A);
  EXPECT_EQ(decode(encode(header)).header, header);
  EXPECT_EQ(decode(encode(header)).error, Error::none);
}

TEST(ImagePlace, MustBeThatOfTheImage) {
  const Header header = header_of(random_body(400, 8));
  const Place place{1, 3, body_address, 400};
  EXPECT_EQ(check_place(header, place), Error::none);
  const auto checked = [&](auto change) {
    Place other = place;
    change(other);
    return check_place(header, other);
  };
  EXPECT_EQ(checked([](Place& other) { other.board_id = 2; }), Error::other_board);
  EXPECT_EQ(checked([](Place& other) { other.revision = 1; }), Error::other_revision);
  EXPECT_EQ(checked([](Place& other) { other.revision = 2; }), Error::none);
  EXPECT_EQ(checked([](Place& other) { other.revision = 5; }), Error::none);
  EXPECT_EQ(checked([](Place& other) { other.revision = 6; }), Error::other_revision);
  EXPECT_EQ(checked([](Place& other) { other.address += 0x200; }), Error::other_address);
  EXPECT_EQ(checked([](Place& other) { other.room = 399; }), Error::too_large);
}

TEST(ImageBody, MustBeTheOneThatTheHeaderDescribes) {
  const std::vector<std::uint8_t> body = random_body(5'000, 9);
  const Header header = header_of(body);
  EXPECT_EQ(check_body(header, body), Error::none);
  EXPECT_EQ(check_body(header, std::span(body).first(4'996)), Error::wrong_length);
  std::vector<std::uint8_t> longer = body;
  longer.resize(5'004);
  EXPECT_EQ(check_body(header, longer), Error::wrong_length);
  std::mt19937 random(10);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::uint8_t> changed = body;
    changed[random() % changed.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    ASSERT_EQ(check_body(header, changed), Error::damaged_body);
  }
}

// A CRC can be made equal on purpose; the SHA-256 cannot.
TEST(ImageBody, IsRefusedIfOnlyItsCrcIsRight) {
  const std::vector<std::uint8_t> body = random_body(64, 11);
  Header header = header_of(body);
  header.hash[31] ^= 1U;
  EXPECT_EQ(check_body(header, body), Error::damaged_body);
  header = header_of(body);
  header.crc ^= 1U;
  EXPECT_EQ(check_body(header, body), Error::damaged_body);
}

TEST(ImageError, HasADescriptionOfItsOwn) {
  std::set<std::string_view> texts;
  for (auto error = Error::none; error <= Error::damaged_body;
       error = static_cast<Error>(static_cast<unsigned>(error) + 1)) {
    EXPECT_NE(describe(error), "unknown error");
    EXPECT_TRUE(texts.insert(describe(error)).second) << describe(error);
  }
}

}  // namespace
}  // namespace proleg::image
