#include "shared/computer/hash/value_hash.hpp"

#include <array>

#include "shared/computer/hash/sha256.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg {

// The results of libsodium's SHA-256 functions are always 0 and are not checked.

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
