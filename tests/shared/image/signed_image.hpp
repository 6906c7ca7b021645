#pragma once

// Keys and signatures of images by libsodium, which knows nothing of the code that checks them.

#include <sodium.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "shared/fixed/little_endian.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::image::test {

/// A pair of keys, made of a number.
struct ImageSigner {
  explicit ImageSigner(std::uint8_t number) {
    std::array<std::uint8_t, crypto_sign_SEEDBYTES> seed{};
    seed.fill(number);
    if (sodium_init() < 0 || crypto_sign_seed_keypair(key.data(), secret.data(), seed.data()) != 0) {
      throw std::runtime_error("libsodium: cannot make a key");
    }
  }

  /// First bytes of the SHA-256 of the public key.
  [[nodiscard]] std::uint32_t id() const {
    std::array<std::uint8_t, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256(hash.data(), key.data(), key.size());
    return std::uint32_t{hash[0]} << 24U | std::uint32_t{hash[1]} << 16U | std::uint32_t{hash[2]} << 8U | hash[3];
  }

  /// Signs the first 508 bytes of the header with the bytes 96 to 159 as 0.
  [[nodiscard]] Header sign(Header header) const {
    header.key_id = id();
    header.signature = {};
    const HeaderBytes bytes = encode(header);
    crypto_sign_detached(header.signature.data(), nullptr, bytes.data(), 508, secret.data());
    return header;
  }

  std::array<std::uint8_t, crypto_sign_PUBLICKEYBYTES> key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
};

}  // namespace proleg::image::test
