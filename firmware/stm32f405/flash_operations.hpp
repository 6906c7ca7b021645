#pragma once

// Functions that erase and program the flash (RM0090, section 3.6).
//
// The flash is one bank: while a sector is erased (16 KiB up to half a second, 128 KiB up to two; data sheet, table 41)
// or a word programmed (up to 0.1 ms), every read of flash stalls the CPU. So the code that waits runs from RAM and
// feeds the watchdog. Interrupts are disabled meanwhile, because their vectors and handlers are in flash. The
// controller keeps three of the frames that come, and others are lost. TIM5 must run: it measures the timeouts.

#include <cstdint>
#include <span>

namespace proleg::stm32f405 {

/// Sets all bytes of the sector (0 to 11) to 0xFF. Returns whether it succeeded within the time.
[[nodiscard]] bool erase_sector(unsigned sector, std::uint32_t timeout_us);

/// Programs bytes that are 0xFF, word by word in ascending order. address, size: multiples of 4. Returns whether it
/// succeeded.
[[nodiscard]] bool program_words(std::uint32_t address, std::span<const std::uint8_t> bytes);

/// Time after which programming a word has failed: at least twice the maximum of the data sheet.
inline constexpr std::uint32_t program_timeout_us = 1'000;

}  // namespace proleg::stm32f405
