#pragma once

#include "firmware/module/board_record.hpp"

namespace proleg::stm32f405 {

/// Sectors 1 and 2 of the flash, 16 KiB each at 0x08004000 and 0x08008000: sectors 0 and 1 of the port (RM0090, section
/// 3.3, table 5). An operation takes up to half a second (flash_operations.hpp); the timer repeats the servo's last
/// pulse meanwhile. The class must be used only while the servo has no power.
class BoardRecordFlash final : public firmware::FlashPort {
 public:
  static constexpr std::uint32_t sector_count = 2;
  static constexpr std::uint32_t sector_size = 16 * 1024;

  [[nodiscard]] bool erase(unsigned sector) override;
  [[nodiscard]] bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override;
};

}  // namespace proleg::stm32f405
