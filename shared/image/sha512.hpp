#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::image {

/// SHA-512 (FIPS 180-4, section 6.4), for modules, which have no library for it. It hashes up to 2^61 - 1 bytes.
class Sha512 {
 public:
  using Hash = std::array<std::uint8_t, 64>;

  void add(std::span<const std::uint8_t> bytes);
  /// Hash of all bytes added so far. It ends the computation: no bytes may be added afterwards.
  [[nodiscard]] Hash finish();

 private:
  static constexpr std::size_t block_size = 128;

  void add_byte(std::uint8_t byte);
  void add_block();

  /// Initial value of the hash (FIPS 180-4, section 5.3.5).
  std::array<std::uint64_t, 8> state_{0x6a09e667f3bcc908, 0xbb67ae8584caa73b, 0x3c6ef372fe94f82b, 0xa54ff53a5f1d36f1,
                                      0x510e527fade682d1, 0x9b05688c2b3e6c1f, 0x1f83d9abfb41bd6b, 0x5be0cd19137e2179};
  /// The block that is being filled, big-endian. add_block() leaves other words, which the next 128 bytes push out.
  std::array<std::uint64_t, 16> words_{};
  std::uint64_t length_ = 0;  ///< number of bytes added
};

[[nodiscard]] Sha512::Hash sha512(std::span<const std::uint8_t> bytes);

}  // namespace proleg::image
