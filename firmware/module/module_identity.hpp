#pragma once

#include <array>
#include <cstdint>

namespace proleg::firmware {

/// Why the program has started.
enum class ResetCause : std::uint8_t {
  power_on,  ///< or the supply broke down
  pin,       ///< the reset button, a programmer
  software,  ///< on request
  watchdog,  ///< the program did not come round any more
  fault,     ///< the program broke a rule of the processor, or one of its own
};

/// What a module is born with, and how it came to life.
struct Board {
  std::uint8_t node = 0;                     ///< 1 to 126
  std::uint16_t board_id = 1;                ///< 1: the reference board
  std::array<std::uint32_t, 3> unique_id{};  ///< 96 bits, the lowest word first
  std::uint32_t core_fingerprint = 0;        ///< of the core it is built from: proleg::core_fingerprint
  std::uint32_t capabilities = 0;            ///< object 0x2000:5, such as canopen::measures_angle
  ResetCause reset_cause = ResetCause::power_on;
  std::uint32_t reset_detail = 0;  ///< of a fault: where the program was (program counter); 0: not known
};

/// CRC-32 of the unique id, little-endian: a serial number for those who have room for 32 bits (object 0x1018).
[[nodiscard]] std::uint32_t serial_number(const Board& board);

}  // namespace proleg::firmware
