#pragma once

// The slots in the flash of the chip, and the start of the program in slot A.

#include "firmware/bootloader/slots.hpp"

namespace proleg::stm32f405 {

/// The flash of the slots. An erase takes up to two seconds (firmware/stm32f405/flash.hpp).
class SlotMemory final : public bootloader::SlotFlash {
 public:
  [[nodiscard]] bool erase(bootloader::FlashSlot slot) override;
  [[nodiscard]] bool program(bootloader::FlashSlot slot, std::uint32_t offset,
                             std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> contents(bootloader::FlashSlot slot) const override;
  [[nodiscard]] bool is_supplied() const override;
};

/// Board and place of images on the reference board.
[[nodiscard]] image::Place image_place();

/// Starts the program in slot A. The chip must be as after a reset, except for the watchdog and the
/// servo's pin, which is low.
[[noreturn]] void start_program();

}  // namespace proleg::stm32f405
