#pragma once

#include <array>
#include <cstdint>

namespace proleg::firmware {

/// What a module is born with.
struct Board {
  std::uint8_t node = 0;                     ///< 1 to 126
  std::uint16_t board_id = 1;                ///< 1: the reference board
  std::array<std::uint32_t, 3> unique_id{};  ///< 96 bits, the lowest word first
  std::uint32_t core_fingerprint = 0;        ///< of the core it is built from: proleg::core_fingerprint
};

/// CRC-32 of the unique id, little-endian: a serial number for those who have room for 32 bits (object 0x1018).
[[nodiscard]] std::uint32_t serial_number(const Board& board);

}  // namespace proleg::firmware
