#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <sodium/crypto_hash_sha256.h>

namespace proleg {

/// SHA-256 of the bytes of a text, 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view text);

/// Writes bytes as lower-case hexadecimal digits, two for each byte.
[[nodiscard]] std::string hexadecimal_digits(std::span<const unsigned char> bytes);

/// SHA-256 over a sequence of int32 values, each as four bytes, little-endian. Two runs on any computers have the same
/// set-points, or the same servo commands, if their hashes are equal.
class ValueHash {
 public:
  ValueHash();

  void append(std::int32_t value);
  void append(std::span<const std::int32_t> values);

  /// Hash of all values so far, 64 lower-case hexadecimal digits. More values may follow.
  [[nodiscard]] std::string hex() const;

 private:
  crypto_hash_sha256_state state_;
  std::array<unsigned char, 256> buffer_;  ///< collects values, which come one by one, into blocks
  std::size_t buffered_ = 0;               ///< number of bytes in the buffer
};

}  // namespace proleg
