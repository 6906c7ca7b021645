#include "shared/image/ed25519.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "ed25519_points.hpp"

namespace proleg::image {
namespace {

using namespace test;

constexpr std::uint32_t signer_seed = 3;

template <std::size_t Size>
std::array<std::uint8_t, Size> random_bytes(std::mt19937& random) {
  std::array<std::uint8_t, Size> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

/// A random number modulo L, not 0.
Scalar random_scalar(std::mt19937& random) {
  const auto wide = random_bytes<64>(random);
  Scalar scalar;
  crypto_core_ed25519_scalar_reduce(scalar.data(), wide.data());
  return scalar;
}

Message message_of_number(unsigned number) {
  const std::string text = "message " + std::to_string(number);
  return {text.begin(), text.end()};
}

/// A signer with a secret number a, and its key A = a B.
struct Signer {
  Scalar secret;
  PublicKey key;
};

Signer signer(std::mt19937& random) {
  const Scalar secret = random_scalar(random);
  return {secret, multiple_of_base(secret)};
}

/// A number modulo 8.
unsigned low_bits(const Scalar& scalar) { return scalar.front() % 8U; }

struct Example {
  const char* name;
  std::string_view key;
  std::string_view message;
  std::string_view signature;
};

/// RFC 8032, section 7.1.
const std::vector<Example>& published_examples() {
  static const std::vector<Example> examples{
      {"TEST 1", "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a", "",
       "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e39701cf9b46b"
       "d25bf5f0595bbe24655141438e7a100b"},
      {"TEST 2", "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c", "72",
       "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da085ac1e43e15996e458f3613d0f11d8c"
       "387b2eaeb4302aeeb00d291612bb0c00"},
      {"TEST 3", "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025", "af82",
       "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac18ff9b538d16f290ae67f760984dc659"
       "4a7c15e9716ed28dc027beceea1ec40a"},
      {"TEST 1024", "278117fc144c72340f67d0f2316e8386ceffbf2b2428c9c51fef7c597f1d426e",
       "08b8b2b733424243760fe426a4b54908632110a66c2f6591eabd3345e3e4eb98fa6e264bf09efe12ee50f8f54e9f77b1"
       "e355f6c50544e23fb1433ddf73be84d879de7c0046dc4996d9e773f4bc9efe5738829adb26c81b37c93a1b270b20329d"
       "658675fc6ea534e0810a4432826bf58c941efb65d57a338bbd2e26640f89ffbc1a858efcb8550ee3a5e1998bd177e93a"
       "7363c344fe6b199ee5d02e82d522c4feba15452f80288a821a579116ec6dad2b3b310da903401aa62100ab5d1a36553e"
       "06203b33890cc9b832f79ef80560ccb9a39ce767967ed628c6ad573cb116dbefefd75499da96bd68a8a97b928a8bbc10"
       "3b6621fcde2beca1231d206be6cd9ec7aff6f6c94fcd7204ed3455c68c83f4a41da4af2b74ef5c53f1d8ac70bdcb7ed1"
       "85ce81bd84359d44254d95629e9855a94a7c1958d1f8ada5d0532ed8a5aa3fb2d17ba70eb6248e594e1a2297acbbb39d"
       "502f1a8c6eb6f1ce22b3de1a1f40cc24554119a831a9aad6079cad88425de6bde1a9187ebb6092cf67bf2b13fd65f270"
       "88d78b7e883c8759d2c4f5c65adb7553878ad575f9fad878e80a0c9ba63bcbcc2732e69485bbc9c90bfbd62481d9089b"
       "eccf80cfe2df16a2cf65bd92dd597b0707e0917af48bbb75fed413d238f5555a7a569d80c3414a8d0859dc65a46128ba"
       "b27af87a71314f318c782b23ebfe808b82b0ce26401d2e22f04d83d1255dc51addd3b75a2b1ae0784504df543af8969b"
       "e3ea7082ff7fc9888c144da2af58429ec96031dbcad3dad9af0dcbaaaf268cb8fcffead94f3c7ca495e056a9b47acdb7"
       "51fb73e666c6c655ade8297297d07ad1ba5e43f1bca32301651339e22904cc8c42f58c30c04aafdb038dda0847dd988d"
       "cda6f3bfd15c4b4c4525004aa06eeff8ca61783aacec57fb3d1f92b0fe2fd1a85f6724517b65e614ad6808d6f6ee34df"
       "f7310fdc82aebfd904b01e1dc54b2927094b2db68d6f903b68401adebf5a7e08d78ff4ef5d63653a65040cf9bfd4aca7"
       "984a74d37145986780fc0b16ac451649de6188a7dbdf191f64b5fc5e2ab47b57f7f7276cd419c17a3ca8e1b939ae49e4"
       "88acba6b965610b5480109c8b17b80e1b7b750dfc7598d5d5011fd2dcc5600a32ef5b52a1ecc820e308aa342721aac09"
       "43bf6686b64b2579376504ccc493d97e6aed3fb0f9cd71a43dd497f01f17c0e2cb3797aa2a2f256656168e6c496afc5f"
       "b93246f6b1116398a346f1a641f3b041e989f7914f90cc2c7fff357876e506b50d334ba77c225bc307ba537152f3f161"
       "0e4eafe595f6d9d90d11faa933a15ef1369546868a7f3a45a96768d40fd9d03412c091c6315cf4fde7cb68606937380d"
       "b2eaaa707b4c4185c32eddcdd306705e4dc1ffc872eeee475a64dfac86aba41c0618983f8741c5ef68d3a101e8a3b8ca"
       "c60c905c15fc910840b94c00a0b9d0",
       "0aab4c900501b3e24d7cdf4663326a3a87df5e4843b2cbdb67cbf6e460fec350aa5371b1508f9f4528ecea23c436d94b"
       "5e8fcd4f681e30a6ac00a9704a188a03"},
      {"TEST SHA(abc)", "ec172b93ad5e563bf4932c70e1245034c35467ef2efd4d64ebf819683467e2bf",
       "ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a2192992a274fc1a836ba3c23a3feebbd"
       "454d4423643ce80e2a9ac94fa54ca49f",
       "dc2a4459e7369633a52b1bf277839a00201009a3efbf3ecb69bea2186c26b58909351fc9ac90b3ecfdfbc7c66431e030"
       "3dca179c138ac17ad9bef1177331a704"},
  };
  return examples;
}

TEST(Ed25519, AcceptsThePublishedSignatures) {
  for (const Example& example : published_examples()) {
    SCOPED_TRACE(example.name);
    const auto key = array_of<32>(example.key);
    EXPECT_TRUE(is_usable(key));
    EXPECT_TRUE(is_signed_by(key, array_of<64>(example.signature), bytes_of(example.message)));
  }
}

TEST(Ed25519, AcceptsMessagesOfAllLengthsOfAFewBlocks) {
  std::mt19937 random(signer_seed);
  const Signer owner = signer(random);
  Message message;
  for (int length = 0; length <= 200; ++length) {
    const Scalar r = random_scalar(random);
    const Signature signature = signature_of(multiple_of_base(r), r, owner.key, owner.secret, message);
    ASSERT_TRUE(is_signed_by(owner.key, signature, message)) << length << " bytes, seed " << signer_seed;
    message.push_back(static_cast<std::uint8_t>(random()));
  }
}

TEST(Ed25519, RejectsEachChangedBit) {
  const Example& example = published_examples()[2];
  const auto key = array_of<32>(example.key);
  const auto signature = array_of<64>(example.signature);
  const Message message = bytes_of(example.message);
  const auto bit = [](unsigned i) { return static_cast<std::uint8_t>(1U << i % 8U); };
  for (unsigned i = 0; i < 8 * signature.size(); ++i) {
    Signature changed = signature;
    changed[i / 8] ^= bit(i);
    EXPECT_FALSE(is_signed_by(key, changed, message)) << "bit " << i << " of the signature";
  }
  for (unsigned i = 0; i < 8 * key.size(); ++i) {
    PublicKey changed = key;
    changed[i / 8] ^= bit(i);
    EXPECT_FALSE(is_signed_by(changed, signature, message)) << "bit " << i << " of the key";
  }
  for (unsigned i = 0; i < 8 * message.size(); ++i) {
    Message changed = message;
    changed[i / 8] ^= bit(i);
    EXPECT_FALSE(is_signed_by(key, signature, changed)) << "bit " << i << " of the message";
  }
  EXPECT_FALSE(is_signed_by(key, signature, std::span(message).first(1)));
}

// L times B is the neutral point, so the equation holds for all these numbers S.
TEST(Ed25519, RejectsOtherNumbersOfTheSameSignature) {
  for (const Example& example : published_examples()) {
    Signature signature = array_of<64>(example.signature);
    const Scalar order = group_order();
    for (int added = 1; added <= 14; ++added) {
      sodium_add(signature.data() + 32, order.data(), order.size());
      ASSERT_GE(signature.back(), 0x10 * added) << "S + " << added << " L has 256 bits";
      EXPECT_FALSE(is_signed_by(array_of<32>(example.key), signature, bytes_of(example.message)))
          << example.name << ", S + " << added << " L";
    }
  }
}

TEST(Ed25519, RejectsKeysOfSmallOrder) {
  const std::set<Encoding> encodings = small_order_encodings();
  ASSERT_EQ(encodings.size(), 14U);
  std::mt19937 random(signer_seed);
  for (const PublicKey& key : encodings) {
    ASSERT_TRUE(is_on_curve(key));
    EXPECT_FALSE(is_usable(key));
    // Without a secret number: S B = R, and h A is the neutral point, for one message of eight at least.
    const Scalar r = random_scalar(random);
    unsigned number = 0;
    while (low_bits(challenge_of(multiple_of_base(r), key, message_of_number(number))) != 0) {
      ++number;
    }
    EXPECT_FALSE(is_signed_by(key, joined(multiple_of_base(r), r), message_of_number(number)))
        << "message " << number << ", seed " << signer_seed;
  }
}

TEST(Ed25519, RejectsPointsOfSmallOrderInASignature) {
  std::mt19937 random(signer_seed);
  const Signer owner = signer(random);
  const std::array<Encoding, 8> points = small_order_points();
  const PublicKey key = sum_of(owner.key, points[0]);
  for (unsigned i = 0; i < points.size(); ++i) {
    // S B - h (a B + T) = -h T is R = (i + 1) T if h + i + 1 is a multiple of 8.
    unsigned number = 0;
    while ((low_bits(challenge_of(points[i], key, message_of_number(number))) + i + 1) % 8 != 0) {
      ++number;
    }
    const Message message = message_of_number(number);
    EXPECT_FALSE(is_signed_by(key, signature_of(points[i], {}, key, owner.secret, message), message))
        << "the point " << i + 1 << " T, message " << number << ", seed " << signer_seed;
  }
  // The same with an ordinary key: r = 0.
  EXPECT_FALSE(is_signed_by(owner.key, signature_of(neutral_point, {}, owner.key, owner.secret, {}), {}));
  for (const Encoding& point : small_order_encodings()) {
    EXPECT_FALSE(is_signed_by(owner.key, signature_of(point, {}, owner.key, owner.secret, {}), {}));
  }
}

TEST(Ed25519, RejectsKeysThatAreNotCanonical) {
  const std::set<Encoding> small = small_order_encodings();
  int usable = 0;
  for (std::uint8_t y = 0; y < 19; ++y) {
    for (const bool has_other_sign : {false, true}) {
      const PublicKey key = has_other_sign ? with_other_sign({y}) : PublicKey{y};
      const PublicKey other = has_other_sign ? with_other_sign(prime_plus(y)) : prime_plus(y);
      const bool is_expected = is_on_curve(key) && !small.contains(key);
      EXPECT_EQ(is_usable(key), is_expected) << "y = " << int{y};
      EXPECT_EQ(is_on_curve(other), is_on_curve(key)) << "y = " << int{y};
      EXPECT_FALSE(is_usable(other)) << "y = p + " << int{y};
      usable += is_expected ? 1 : 0;
    }
  }
  EXPECT_GT(usable, 8);
}

TEST(Ed25519, RejectsKeysThatAreNoPoints) {
  std::mt19937 random(signer_seed);
  int points = 0;
  constexpr int keys = 400;
  for (int i = 0; i < keys; ++i) {
    auto key = random_bytes<32>(random);
    if (i % 4 == 0) {  // close to p
      key = prime_plus(0);
      key.front() = static_cast<std::uint8_t>(random() % 0xEC);
      key[1] = static_cast<std::uint8_t>(random());
    }
    ASSERT_EQ(is_usable(key), is_on_curve(key)) << "key " << i << ", seed " << signer_seed;
    points += is_on_curve(key) ? 1 : 0;
  }
  EXPECT_NEAR(points, 0.5 * keys, 0.1 * keys);
}

// For R = r B + j T and a key A + T it is S B - h A = r B - h T. That is R for one h of eight.
TEST(Ed25519, LetsTheEquationDecideAboutPointsOfMixedOrder) {
  std::mt19937 random(signer_seed);
  const Signer owner = signer(random);
  const std::array<Encoding, 8> points = small_order_points();
  const PublicKey key = sum_of(owner.key, points[0]);
  EXPECT_TRUE(is_usable(key));
  int valid = 0;
  for (unsigned i = 0; i < 128; ++i) {
    const unsigned j = i % 8;
    const Scalar r = random_scalar(random);
    const Encoding point = j == 0 ? multiple_of_base(r) : sum_of(multiple_of_base(r), points[j - 1]);
    const Message message = message_of_number(i);
    const bool is_expected = (low_bits(challenge_of(point, key, message)) + j) % 8 == 0;
    EXPECT_EQ(is_signed_by(key, signature_of(point, r, key, owner.secret, message), message), is_expected)
        << "message " << i << ", seed " << signer_seed;
    valid += is_expected ? 1 : 0;
  }
  EXPECT_GT(valid, 0);
}

// Programs that multiply both sides of the equation by 8 accept these signatures.
TEST(Ed25519, RejectsAnAddedPointOfSmallOrder) {
  std::mt19937 random(signer_seed);
  const Signer owner = signer(random);
  const std::array<Encoding, 8> points = small_order_points();
  for (unsigned i = 0; i < points.size(); ++i) {
    const Scalar r = random_scalar(random);
    const Encoding point = sum_of(multiple_of_base(r), points[i]);
    const Message message = message_of_number(i);
    const bool is_neutral = i == 7;
    EXPECT_EQ(is_signed_by(owner.key, signature_of(point, r, owner.key, owner.secret, message), message), is_neutral);
  }
}

// The sum is r B. Only the highest bit of its encoding differs from that of R = -r B.
TEST(Ed25519, RejectsTheOppositeOfThePoint) {
  std::mt19937 random(signer_seed);
  const Signer owner = signer(random);
  const Scalar r = random_scalar(random);
  const Encoding point = with_other_sign(multiple_of_base(r));
  EXPECT_FALSE(is_signed_by(owner.key, signature_of(point, r, owner.key, owner.secret, {}), {}));
}

}  // namespace
}  // namespace proleg::image
