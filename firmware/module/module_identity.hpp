#pragma once

#include <array>
#include <cstdint>

namespace proleg::firmware {

/// Why the program has started.
enum class ResetCause : std::uint8_t {
  power_on,  ///< or a supply voltage that was too low
  pin,       ///< the reset button, a programmer
  software,  ///< on request
  watchdog,  ///< the program has not fed the watchdog in time
  fault,     ///< the program broke a rule of the processor, or one of its own
  clock,     ///< the crystal or the PLL had stopped or had not started
};

/// What distinguishes a module from all others, and why its program has started.
struct ModuleIdentity {
  std::uint8_t node = 0;                     ///< 1 to 126; 0: none. Module takes it from the board record and LSS
  std::uint16_t board_id = 1;                ///< 1: the reference board
  std::array<std::uint32_t, 3> unique_id{};  ///< 96 bits, the lowest word first
  std::uint32_t core_fingerprint = 0;        ///< of the core it is built from: proleg::core_fingerprint
  std::uint32_t capabilities = 0;            ///< object 0x2000:5. Module takes measures_angle from the board record
  ResetCause reset_cause = ResetCause::power_on;
  std::uint32_t reset_detail = 0;  ///< of fault and clock: where the program was (program counter); 0: not known
};

/// The serial number of object 0x1018, which has 32 bits: CRC-32 of the unique id, little-endian.
[[nodiscard]] std::uint32_t serial_number(const ModuleIdentity& identity);

/// From the start of the module to its boot-up, 1,000 to 16,000: of two modules with one node id that are switched on
/// together, one receives the other's message.
[[nodiscard]] inline std::uint32_t boot_up_delay_us(const ModuleIdentity& identity) {
  return 1'000U * (1U + serial_number(identity) % 16U);
}

}  // namespace proleg::firmware
