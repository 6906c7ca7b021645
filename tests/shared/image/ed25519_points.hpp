#pragma once

// Keys, points and signatures that no ordinary signer makes, computed with the arithmetic of libsodium.

#include <sodium.h>

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "shared/image/ed25519.hpp"

namespace proleg::image::test {

using Message = std::vector<std::uint8_t>;
/// A number modulo L, or any number below 2^256: the lowest byte first.
using Scalar = std::array<std::uint8_t, 32>;
/// The encoding of a point. A key is one, too.
using Encoding = PublicKey;

inline constexpr Encoding neutral_point{1};

inline void check(int result) {
  if (result != 0) {
    throw std::runtime_error("libsodium: cannot compute with a point of the curve");
  }
}

/// The bytes that hexadecimal digits give, the first byte first.
inline Message bytes_of(std::string_view digits) {
  Message bytes(digits.size() / 2);
  if (bytes.empty()) {
    return bytes;
  }
  check(sodium_hex2bin(bytes.data(), bytes.size(), digits.data(), digits.size(), nullptr, nullptr, nullptr));
  return bytes;
}

template <std::size_t Size>
std::array<std::uint8_t, Size> array_of(std::string_view digits) {
  const Message bytes = bytes_of(digits);
  std::array<std::uint8_t, Size> array{};
  for (std::size_t i = 0; i < Size; ++i) {
    array[i] = bytes.at(i);
  }
  return array;
}

/// L (RFC 8032, section 5.1).
inline Scalar group_order() { return array_of<32>("edd3f55c1a631258d69cf7a2def9de1400000000000000000000000000000010"); }

/// 2^255 - 19 + low, of which low is 18 at most: an encoding of y = low that is not canonical.
inline Encoding prime_plus(unsigned low) {
  Encoding encoding;
  encoding.fill(0xFF);
  encoding.front() = static_cast<std::uint8_t>(0xED + low);
  encoding.back() = 0x7F;
  return encoding;
}

inline Encoding with_other_sign(Encoding encoding) {
  encoding.back() ^= 0x80U;
  return encoding;
}

/// Whether bytes give a point by the rules of libsodium, which do not demand a canonical encoding here.
inline bool is_on_curve(const Encoding& encoding) {
  Encoding sum;
  return crypto_core_ed25519_add(sum.data(), encoding.data(), neutral_point.data()) == 0;
}

inline Encoding sum_of(const Encoding& one, const Encoding& other) {
  Encoding sum;
  check(crypto_core_ed25519_add(sum.data(), one.data(), other.data()));
  return sum;
}

/// The multiple of any point, for the factor as a whole number.
inline Encoding multiple_of(const Scalar& factor, const Encoding& point) {
  Encoding multiple = neutral_point;
  for (unsigned bit = 256; bit-- > 0;) {
    multiple = sum_of(multiple, multiple);
    if ((factor[bit / 8] >> (bit % 8) & 1U) != 0) {
      multiple = sum_of(multiple, point);
    }
  }
  return multiple;
}

inline Encoding multiple_of_base(const Scalar& factor) {
  Encoding multiple;
  check(crypto_scalarmult_ed25519_base_noclamp(multiple.data(), factor.data()));
  return multiple;
}

/// The eight points T, 2 T, ... 8 T of which T has the order 8, so the last is the neutral point.
inline std::array<Encoding, 8> small_order_points() {
  for (std::uint8_t y = 2;; ++y) {
    // L times a point has an order that divides 8. For every other point it is 8.
    if (!is_on_curve({y})) {
      continue;
    }
    std::array<Encoding, 8> points{multiple_of(group_order(), {y})};
    for (std::size_t i = 1; i < points.size(); ++i) {
      points[i] = sum_of(points[i - 1], points[0]);
    }
    if (points[3] != neutral_point) {
      return points;
    }
  }
}

/// All encodings of these points that a reader can take for one of them: also with y + p, and with a negative 0.
inline std::set<Encoding> small_order_encodings() {
  std::set<Encoding> encodings;
  for (Encoding point : small_order_points()) {
    point.back() &= 0x7FU;
    for (const Encoding& y : {point, point == neutral_point ? prime_plus(1)
                                     : point == Encoding{}  ? prime_plus(0)
                                                            : point}) {
      encodings.insert(y);
      encodings.insert(with_other_sign(y));
    }
  }
  return encodings;
}

/// h: the hash of R, A and the message, modulo L.
inline Scalar challenge_of(const Encoding& point, const PublicKey& key, const Message& message) {
  Message bytes(point.begin(), point.end());
  bytes.insert(bytes.end(), key.begin(), key.end());
  bytes.insert(bytes.end(), message.begin(), message.end());
  std::array<std::uint8_t, crypto_hash_sha512_BYTES> hash{};
  crypto_hash_sha512(hash.data(), bytes.data(), bytes.size());
  Scalar challenge;
  crypto_core_ed25519_scalar_reduce(challenge.data(), hash.data());
  return challenge;
}

inline Signature joined(const Encoding& point, const Scalar& number) {
  Signature signature{};
  for (std::size_t i = 0; i < 32; ++i) {
    signature[i] = point[i];
    signature[32 + i] = number[i];
  }
  return signature;
}

/// R and S = r + h a, for any R and A.
inline Signature signature_of(const Encoding& point, const Scalar& r, const PublicKey& key, const Scalar& a,
                              const Message& message) {
  Scalar number;
  crypto_core_ed25519_scalar_mul(number.data(), challenge_of(point, key, message).data(), a.data());
  crypto_core_ed25519_scalar_add(number.data(), number.data(), r.data());
  return joined(point, number);
}

inline bool is_signed_for_libsodium(const PublicKey& key, const Signature& signature,
                                    std::span<const std::uint8_t> message) {
  return crypto_sign_verify_detached(signature.data(), message.data(), message.size(), key.data()) == 0;
}

}  // namespace proleg::image::test
