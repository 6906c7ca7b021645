#pragma once

#include <array>
#include <cstdint>

#include "shared/fixed/crc32.hpp"

namespace proleg::firmware {

/// Causes of the start of a program.
enum class ResetCause : std::uint8_t {
  power_on,  ///< power-on, or a supply voltage that was too low
  pin,       ///< the reset button, or a programmer
  software,  ///< the program has requested it
  watchdog,  ///< the program has not fed the watchdog in time
  fault,     ///< the program broke a rule of the processor, or one of its own
  clock,     ///< the crystal or the PLL had stopped or had not started
};

/// The properties that distinguish a module from all others, and the cause of its program's start.
struct ModuleIdentity {
  std::uint8_t node = 0;                     ///< 1 to 126; 0: none. Module takes it from the board record and LSS
  std::uint16_t board_id = 1;                ///< 1: the reference board
  std::array<std::uint32_t, 3> unique_id{};  ///< 96 bits, the lowest word first
  std::uint32_t core_fingerprint = 0;        ///< fingerprint of the core it is built from: proleg::core_fingerprint
  std::uint32_t capabilities = 0;            ///< bits of object 0x2000:5. measures_angle is the board record's
  ResetCause reset_cause = ResetCause::power_on;
  std::uint32_t reset_detail = 0;  ///< for fault and clock: where the program was (program counter); 0: not known
};

/// The serial number of object 0x1018, which has 32 bits: the CRC-32 of the unique id, little-endian.
[[nodiscard]] inline std::uint32_t serial_number(const ModuleIdentity& identity) {
  Crc32 crc;
  for (const std::uint32_t word : identity.unique_id) {
    crc.add_little_endian(word, 4);
  }
  return crc.value();
}

/// Time from the start of the module to its boot-up, 1,000 to 16,000: one of two modules with the same node id that are
/// switched on together receives the other's message.
[[nodiscard]] inline std::uint32_t boot_up_delay_us(const ModuleIdentity& identity) {
  return 1'000U * (1U + serial_number(identity) % 16U);
}

}  // namespace proleg::firmware
