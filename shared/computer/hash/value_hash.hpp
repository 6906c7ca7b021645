#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <sodium/crypto_hash_sha256.h>

namespace proleg {

/// SHA-256 over a sequence of int32 values, each as four bytes, little-endian: the fingerprint by which the set-points,
/// or the servo commands, of two runs, on whatever machine, are said to be the same.
class ValueHash {
 public:
  ValueHash();

  void append(std::int32_t value);
  void append(std::span<const std::int32_t> values);

  /// Hash of everything appended so far, 64 lower-case hexadecimal digits. More may be appended afterwards.
  [[nodiscard]] std::string hex() const;

 private:
  crypto_hash_sha256_state state_;
  /// Values come one by one and the hash takes blocks: what waits for more.
  std::array<unsigned char, 256> waiting_;
  std::size_t waiting_size_ = 0;
};

}  // namespace proleg
