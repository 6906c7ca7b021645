#pragma once

// The flash of the chip: functions that erase and program it (RM0090, section 3.6), and the part for board records.
//
// The flash is one bank: while a sector is erased (16 KiB up to half a second, 128 KiB up to two; data sheet, table 41)
// or a word programmed (up to 0.1 ms), every read of flash stalls the CPU. So the code that waits runs from RAM and
// feeds the watchdog. Interrupts are disabled meanwhile, because their vectors and handlers are in flash. The
// controller keeps three of the frames that come, and others are lost. TIM5 must run: it measures the timeouts.

#include <cstdint>
#include <span>

#include "firmware/module/board_record.hpp"

namespace proleg::stm32f405 {

/// Sets all bytes of the sector (0 to 11) to 0xFF. Returns whether it succeeded within the time; false, too, if the
/// supply is too low (is_flash_supplied()).
[[nodiscard]] bool erase_sector(unsigned sector, std::uint32_t timeout_us);

/// Programs bytes that are 0xFF, word by word in ascending order. address, size: multiples of 4. Returns whether it
/// succeeded; false, too, if the supply is too low.
[[nodiscard]] bool program_words(std::uint32_t address, std::span<const std::uint8_t> bytes);

/// Time after which programming a word has failed: at least twice the maximum of the data sheet.
inline constexpr std::uint32_t program_timeout_us = 1'000;

/// Sectors 2 and 3 of the flash, 16 KiB each at 0x08008000 and 0x0800C000: sectors 0 and 1 of the port (RM0090, section
/// 3.3, table 5). An operation takes up to half a second; the timer repeats the servo's last pulse meanwhile. The
/// class must be used only while the servo has no power.
class BoardRecordFlash final : public firmware::FlashPort {
 public:
  static constexpr std::uint32_t sector_count = 2;
  static constexpr std::uint32_t sector_size = 16 * 1024;

  [[nodiscard]] bool erase(unsigned sector) override;
  [[nodiscard]] bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override;
};

}  // namespace proleg::stm32f405
