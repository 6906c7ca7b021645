#include "shared/computer/hash/sha256.hpp"

#include "shared/fixed/little_endian.hpp"

namespace proleg {

// The results of libsodium's SHA-256 functions are always 0 and are not checked.

std::string sha256_hex(std::string_view text) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest;
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
  return hexadecimal_digits(digest);
}

std::string hexadecimal_digits(std::span<const unsigned char> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

ValueHash::ValueHash() { crypto_hash_sha256_init(&state_); }

void ValueHash::append(std::int32_t value) {
  write_little_endian(buffer_, buffered_, sizeof(value), static_cast<std::uint32_t>(value));
  buffered_ += sizeof(value);
  if (buffered_ == buffer_.size()) {
    crypto_hash_sha256_update(&state_, buffer_.data(), buffered_);
    buffered_ = 0;
  }
}

void ValueHash::append(std::span<const std::int32_t> values) {
  for (const std::int32_t value : values) {
    append(value);
  }
}

std::string ValueHash::hex() const {
  // Finishing destroys the state, so a copy is finished.
  crypto_hash_sha256_state state = state_;
  crypto_hash_sha256_update(&state, buffer_.data(), buffered_);
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest;
  crypto_hash_sha256_final(&state, digest.data());
  return hexadecimal_digits(digest);
}

}  // namespace proleg
