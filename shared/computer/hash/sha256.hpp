#pragma once

#include <openssl/types.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "shared/fixed/little_endian.hpp"

namespace proleg {

/// SHA-256 of the bytes of a text, 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view text);

/// Writes bytes as lower-case hexadecimal digits, two for each byte.
[[nodiscard]] std::string hexadecimal_digits(std::span<const unsigned char> bytes);

/// SHA-256 over a sequence of int32 values, each as four bytes, little-endian. Two runs on any computers have the same
/// set-points, or the same servo commands, if their hashes are equal. A simulation hashes each tick: libcrypto uses the
/// processor's instructions for SHA-256.
class ValueHash {
 public:
  ValueHash();

  void append(std::int32_t value) {
    write_little_endian(buffer_, buffered_, sizeof(value), static_cast<std::uint32_t>(value));
    buffered_ += sizeof(value);
    if (buffered_ == buffer_.size()) {
      append_buffer();
    }
  }
  void append(std::span<const std::int32_t> values);
  /// The eight bytes of a number, little-endian.
  void append_number(double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    append(static_cast<std::int32_t>(bits));
    append(static_cast<std::int32_t>(bits >> 32U));
  }

  /// Hash of all values so far, 64 lower-case hexadecimal digits. More values may follow.
  [[nodiscard]] std::string hex() const;

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const;
  };

  void append_buffer();

  std::unique_ptr<EVP_MD_CTX, Free> context_;
  std::array<unsigned char, 256> buffer_;  ///< collects values, which come one by one, into blocks
  std::size_t buffered_ = 0;               ///< number of bytes in the buffer
};

}  // namespace proleg
