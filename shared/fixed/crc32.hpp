#pragma once

#include <cstdint>
#include <span>

namespace proleg {

/// The checksum of Ethernet (IEEE 802.3, section 3.2.9; CRC-32/ISO-HDLC in the usual lists): polynomial 0x04C11DB7,
/// reflected, start and final inversion. It detects accidental changes, not intended ones.
class Crc32 {
 public:
  void add(std::uint8_t byte);
  void add(std::span<const std::uint8_t> bytes);
  /// Adds the low `size` bytes of a value, lowest byte first.
  void add_little_endian(std::uint64_t value, unsigned size);

  /// Checksum of all bytes added so far; 0 if there were none. More bytes may follow.
  [[nodiscard]] std::uint32_t value() const { return ~remainder_; }

 private:
  std::uint32_t remainder_ = 0xFFFFFFFF;
};

[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes);

}  // namespace proleg
