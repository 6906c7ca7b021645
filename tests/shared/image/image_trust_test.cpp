#include "shared/image/image_trust.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "shared/fixed/crc32.hpp"
#include "signed_image.hpp"

namespace proleg::image {
namespace {

const test::ImageSigner maker(1);
const test::ImageSigner stranger(2);

Header header_of_version(const Version& version) {
  Header header;
  header.board_id = 1;
  header.version = version;
  header.address = 0x0802'0200;
  describe_body(header, std::vector<std::uint8_t>(64, 0x11));
  return header;
}

Trust trust_in(const test::ImageSigner& signer, const Version& minimum = {}) { return {signer.key, minimum}; }

TEST(ImageTrust, WithoutAKeyTakesAnyImage) {
  Header forged = header_of_version({1, 0, 0});
  EXPECT_EQ(check_trust({}, encode(forged)), Error::none);
  EXPECT_EQ(check_trust({{}, {2, 0, 0}}, encode(maker.sign(forged))), Error::none);
  forged.key_id = 77;
  EXPECT_EQ(check_trust({}, encode(forged)), Error::none);
}

TEST(ImageTrust, TakesWhatLibsodiumHasSigned) {
  for (unsigned number = 3; number < 20; ++number) {
    const test::ImageSigner signer(static_cast<std::uint8_t>(number));
    EXPECT_EQ(key_id(signer.key), signer.id());
    EXPECT_EQ(check_trust(trust_in(signer), encode(signer.sign(header_of_version({1, 2, 3})))), Error::none);
  }
}

TEST(ImageTrust, RefusesAnImageWithoutASignature) {
  EXPECT_EQ(check_trust(trust_in(maker), encode(header_of_version({1, 0, 0}))), Error::not_signed);
  Header header = maker.sign(header_of_version({1, 0, 0}));
  header.key_id = 0;
  EXPECT_EQ(check_trust(trust_in(maker), encode(header)), Error::not_signed);
}

TEST(ImageTrust, RefusesAnotherKey) {
  Header header = stranger.sign(header_of_version({1, 0, 0}));
  EXPECT_EQ(check_trust(trust_in(maker), encode(header)), Error::other_key);
  header.key_id = maker.id();
  EXPECT_EQ(check_trust(trust_in(maker), encode(header)), Error::wrong_signature);
}

// The signature covers all bytes but itself and the CRC, which anybody can compute.
TEST(ImageTrust, RefusesASignedHeaderOfWhichAnyByteWasChanged) {
  const HeaderBytes bytes = encode(maker.sign(header_of_version({1, 0, 0})));
  for (std::size_t i = 0; i < layout::header_crc_at; ++i) {
    HeaderBytes changed = bytes;
    changed[i] ^= 0x10;
    const bool is_id = i >= layout::key_at && i < layout::key_at + 4;
    ASSERT_EQ(check_trust(trust_in(maker), changed), is_id ? Error::other_key : Error::wrong_signature) << i;
  }
}

// The header has the SHA-256 of the body: another body needs another header.
TEST(ImageTrust, CoversTheBody) {
  Header header = maker.sign(header_of_version({1, 0, 0}));
  const std::vector<std::uint8_t> body(64, 0x12);
  EXPECT_EQ(check_body(header, body), Error::damaged_body);
  describe_body(header, body);
  EXPECT_EQ(check_trust(trust_in(maker), encode(header)), Error::wrong_signature);
}

TEST(ImageTrust, RefusesAVersionBelowTheLowest) {
  const Trust trust = trust_in(maker, {1, 2, 3});
  for (const Version& version : {Version{0, 9, 9}, Version{1, 1, 9}, Version{1, 2, 2}}) {
    EXPECT_EQ(check_trust(trust, encode(maker.sign(header_of_version(version)))), Error::version_too_old);
  }
  for (const Version& version : {Version{1, 2, 3}, Version{1, 3, 0}, Version{2, 0, 0}}) {
    EXPECT_EQ(check_trust(trust, encode(maker.sign(header_of_version(version)))), Error::none);
  }
}

TEST(ImageTrust, RefusesAKeyOfSmallOrder) {
  Trust trust = trust_in(maker);
  trust.key = PublicKey{1};  // the neutral point: R = S B fits every message
  Header header = header_of_version({1, 0, 0});
  header.key_id = key_id(*trust.key);
  header.signature = {1};
  EXPECT_EQ(check_trust(trust, encode(header)), Error::wrong_signature);

  Header next = header_of_version({1, 0, 0});
  next.next_key = {1};
  EXPECT_EQ(check_trust(trust_in(maker), encode(maker.sign(next))), Error::unusable_key);
  next.next_key = stranger.key;
  EXPECT_EQ(check_trust(trust_in(maker), encode(maker.sign(next))), Error::none);
}

TEST(ImageTrust, LowestVersionOnlyRises) {
  Header header = header_of_version({3, 0, 0});
  const Trust trust = trust_in(maker, {2, 0, 0});
  EXPECT_EQ(trust_after(trust, encode(header)), trust);
  header.minimum_version = {1, 9, 9};
  EXPECT_EQ(trust_after(trust, encode(header)), trust);
  header.minimum_version = {2, 0, 1};
  EXPECT_EQ(trust_after(trust, encode(header)), trust_in(maker, {2, 0, 1}));
}

TEST(ImageTrust, NextKeyReplacesTheKeyButIsNotTheFirst) {
  Header header = header_of_version({3, 0, 0});
  header.next_key = stranger.key;
  header.minimum_version = {3, 0, 0};
  EXPECT_EQ(trust_after(trust_in(maker), encode(header)), trust_in(stranger, {3, 0, 0}));
  EXPECT_EQ(trust_after({}, encode(header)), Trust{});
}

}  // namespace
}  // namespace proleg::image
