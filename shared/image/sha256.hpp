#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::image {

/// SHA-256 (FIPS 180-4, section 6.2), for modules, which have no library for it.
class Sha256 {
 public:
  using Hash = std::array<std::uint8_t, 32>;

  void add(std::span<const std::uint8_t> bytes);
  /// Hash of all bytes added so far. It ends the computation: no bytes may be added afterwards.
  [[nodiscard]] Hash finish();

 private:
  static constexpr std::size_t block_size = 64;

  void add_byte(std::uint8_t byte);
  void add_block();

  /// Initial value of the hash (FIPS 180-4, section 5.3.3).
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, block_size> block_{};
  std::uint64_t length_ = 0;  ///< number of bytes added
};

[[nodiscard]] Sha256::Hash sha256(std::span<const std::uint8_t> bytes);

}  // namespace proleg::image
