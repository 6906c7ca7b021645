// Random signatures and random errors in them: each is valid for this code exactly if it is for libsodium.
// PROLEG_SIGNATURES is the number of signatures, PROLEG_SEED chooses them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "ed25519_points.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::image {
namespace {

using namespace test;

/// A signed message. libsodium signs it.
struct Signed {
  PublicKey key;
  Signature signature;
  Message message;
};

class Errors {
 public:
  explicit Errors(std::uint32_t seed) : random_(seed) {}

  static constexpr unsigned kinds = 16;

  Signed next_signed() {
    std::array<std::uint8_t, crypto_sign_SEEDBYTES> secret_seed{};
    fill(secret_seed);
    std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
    Signed all{{}, {}, Message(random_() % 260)};
    fill(all.message);
    check(crypto_sign_seed_keypair(all.key.data(), secret.data(), secret_seed.data()));
    check(crypto_sign_detached(all.signature.data(), nullptr, all.message.data(), all.message.size(), secret.data()));
    return all;
  }

  /// Makes an error of this kind, below `kinds`. Kind 0 is none.
  void spoil(Signed& all, unsigned kind) {
    const auto point = std::span(all.signature).first<32>();
    const auto number = std::span(all.signature).last<32>();
    switch (kind) {
      case 1:
        return flip_bit(number);
      case 2:
        return flip_bit(point);
      case 3:
        return flip_bit(all.key);
      case 4:
        return all.message.empty() ? all.message.push_back(0) : flip_bit(all.message);
      case 5:
        return random_() % 2 == 0 || all.message.empty() ? all.message.push_back(byte()) : all.message.pop_back();
      case 6: {
        const Scalar order = group_order();
        for (std::uint32_t times = 1 + random_() % 15; times > 0; --times) {
          sodium_add(number.data(), order.data(), order.size());
        }
        return;
      }
      case 7:
        return put(small_order_encoding(), point);
      case 8:
        return put(small_order_encoding(), all.key);
      case 9:
        return put(not_canonical(), random_() % 2 == 0 ? point : std::span<std::uint8_t, 32>(all.key));
      case 10:
        std::swap_ranges(point.begin(), point.end(), all.key.begin());
        return;
      case 11:
        std::ranges::fill(any_part(all), std::uint8_t{0});
        return;
      case 12:
        std::ranges::fill(any_part(all), std::uint8_t{0xFF});
        return;
      case 13:
        return fill(any_part(all));
      case 14:
        return add_small_order_point(all.key);
      case 15:
        return add_small_order_point(point);
      default:
        return;
    }
  }

  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }

 private:
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  void fill(std::span<std::uint8_t> bytes) {
    std::ranges::generate(bytes, [this] { return byte(); });
  }
  void flip_bit(std::span<std::uint8_t> bytes) {
    bytes[random_() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random_() % 8U);
  }
  static void put(std::span<const std::uint8_t> from, std::span<std::uint8_t> into) {
    std::ranges::copy(from, into.begin());
  }
  void add_small_order_point(std::span<std::uint8_t, 32> to) {
    Encoding encoding{};
    put(to, encoding);
    if (is_on_curve(encoding)) {  // an error before may have changed that
      put(sum_of(encoding, points_[random_() % 7]), to);
    }
  }
  Encoding small_order_encoding() { return encodings_[random_() % encodings_.size()]; }
  Encoding not_canonical() {
    const Encoding encoding = prime_plus(below(19));
    return random_() % 2 == 0 ? encoding : with_other_sign(encoding);
  }
  /// The key, R, S, or both R and S.
  std::span<std::uint8_t> any_part(Signed& all) {
    switch (random_() % 4) {
      case 0:
        return all.key;
      case 1:
        return std::span(all.signature).first(32);
      case 2:
        return std::span(all.signature).last(32);
      default:
        return all.signature;
    }
  }

  std::mt19937 random_;
  std::array<Encoding, 8> points_ = small_order_points();
  std::vector<Encoding> encodings_ = [] {
    const std::set<Encoding> all = small_order_encodings();
    return std::vector<Encoding>(all.begin(), all.end());
  }();
};

TEST(Ed25519Comparison, AcceptsWhatLibsodiumAccepts) {
  const std::uint32_t count = from_environment("PROLEG_SIGNATURES", 3'000);
  const std::uint32_t seed = from_environment("PROLEG_SEED", 5);
  std::printf("%u signatures, seed %u\n", count, seed);
  Errors errors(seed);
  std::uint32_t valid = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    Signed all = errors.next_signed();
    const unsigned kind = errors.below(Errors::kinds);
    errors.spoil(all, kind);
    if (errors.below(8) == 0) {
      errors.spoil(all, errors.below(Errors::kinds));
    }
    const bool is_expected = is_signed_for_libsodium(all.key, all.signature, all.message);
    ASSERT_EQ(is_signed_by(all.key, all.signature, all.message), is_expected)
        << "signature " << i << ", error of kind " << kind << ", seed " << seed;
    valid += is_expected ? 1U : 0U;
  }
  // All that have no error, and few of the others.
  EXPECT_GT(valid, count / (2 * Errors::kinds));
  EXPECT_LT(valid, count / 8);
}

// Signatures that obey the equation, so that the other rules decide: small and mixed orders in all combinations.
TEST(Ed25519Comparison, TreatsSpecialPointsAsLibsodium) {
  const std::array<Encoding, 8> points = small_order_points();
  Scalar secret{7};
  const PublicKey ordinary = multiple_of_base(secret);
  const Encoding base = multiple_of_base({1});
  std::vector<std::pair<PublicKey, Scalar>> keys;
  std::vector<std::pair<Encoding, Scalar>> nonces;
  for (const Encoding& encoding : small_order_encodings()) {
    keys.emplace_back(encoding, Scalar{});
    nonces.emplace_back(encoding, Scalar{});
  }
  for (const Encoding& point : points) {
    keys.emplace_back(sum_of(ordinary, point), secret);
    nonces.emplace_back(sum_of(base, point), Scalar{1});
  }
  int valid = 0;
  for (const auto& [key, a] : keys) {
    for (const auto& [point, r] : nonces) {
      for (std::uint8_t text = 0; text < 4; ++text) {
        const Signature signature = signature_of(point, r, key, a, {text});
        const bool is_expected = is_signed_for_libsodium(key, signature, Message{text});
        ASSERT_EQ(is_signed_by(key, signature, Message{text}), is_expected);
        valid += is_expected ? 1 : 0;
      }
    }
  }
  EXPECT_GT(valid, 0);
}

}  // namespace
}  // namespace proleg::image
