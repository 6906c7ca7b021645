#pragma once

#include "firmware/bootloader/slots.hpp"

namespace proleg::stm32f405 {

/// The slots in the flash of the chip. An erase takes up to two seconds (firmware/stm32f405/flash_operations.hpp).
class SlotMemory final : public bootloader::SlotFlash {
 public:
  [[nodiscard]] bool erase(bootloader::FlashSlot slot) override;
  [[nodiscard]] bool program(bootloader::FlashSlot slot, std::uint32_t offset,
                             std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> contents(bootloader::FlashSlot slot) const override;
};

}  // namespace proleg::stm32f405
