#include "firmware/stm32f405/bootloader/slot_memory.hpp"

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/flash_operations.hpp"

namespace proleg::stm32f405 {
namespace {

using bootloader::FlashSlot;

/// Time after which an erase has failed: twice the maximum of the data sheet for 128 KiB.
constexpr std::uint32_t erase_timeout_us = 4'000'000;

constexpr const flash_layout::Sector& sector_of(FlashSlot slot) {
  return slot == FlashSlot::a ? flash_layout::image_sector_a : flash_layout::image_sector_b;
}

}  // namespace

bool SlotMemory::erase(FlashSlot slot) { return erase_sector(sector_of(slot).number, erase_timeout_us); }

bool SlotMemory::program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  const flash_layout::Sector& sector = sector_of(slot);
  return offset <= sector.size && bytes.size() <= sector.size - offset && offset % 4 == 0 && bytes.size() % 4 == 0 &&
         program_words(sector.address + offset, bytes);
}

std::span<const std::uint8_t> SlotMemory::contents(FlashSlot slot) const {
  const flash_layout::Sector& sector = sector_of(slot);
  return {reinterpret_cast<const std::uint8_t*>(std::uintptr_t{sector.address}), sector.size};
}

}  // namespace proleg::stm32f405
