#include "shared/computer/hash/value_hash.hpp"

#include <array>

namespace proleg {

// The results of libsodium's SHA-256 functions are not looked at: they are 0 always.

ValueHash::ValueHash() { crypto_hash_sha256_init(&state_); }

void ValueHash::append(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    waiting_[waiting_size_++] = static_cast<unsigned char>(bits >> shift);
  }
  if (waiting_size_ == waiting_.size()) {
    crypto_hash_sha256_update(&state_, waiting_.data(), waiting_size_);
    waiting_size_ = 0;
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
  crypto_hash_sha256_update(&state, waiting_.data(), waiting_size_);
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest;
  crypto_hash_sha256_final(&state, digest.data());
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : digest) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace proleg
