#include "firmware/stm32f405/bootloader/program_slots.hpp"

#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/flash.hpp"
#include "firmware/stm32f405/supply.hpp"
#include "firmware/stm32f405/vector_table.hpp"

namespace proleg::stm32f405 {
namespace {

using bootloader::FlashSlot;
using flash_layout::image_body;
// The vector table of the program has 98 words, so its address must be a multiple of 512 (PM0214, section 4.4.4).
static_assert(image_body % 512 == 0);

/// Time after which an erase has failed: twice the maximum of the data sheet for 128 KiB.
constexpr std::uint32_t erase_timeout_us = 4'000'000;

constexpr const flash_layout::Sector& sector_of(FlashSlot slot) {
  return slot == FlashSlot::a   ? flash_layout::image_sector_a
         : slot == FlashSlot::b ? flash_layout::image_sector_b
                                : flash_layout::trust_sector;
}

}  // namespace

bool SlotMemory::erase(FlashSlot slot) {
  return slot != FlashSlot::trust && erase_sector(sector_of(slot).number, erase_timeout_us);
}

bool SlotMemory::program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  const flash_layout::Sector& sector = sector_of(slot);
  return offset <= sector.size && bytes.size() <= sector.size - offset && offset % 4 == 0 && bytes.size() % 4 == 0 &&
         program_words(sector.address + offset, bytes);
}

bool SlotMemory::is_supplied() const { return is_flash_supplied(); }

std::span<const std::uint8_t> SlotMemory::contents(FlashSlot slot) const {
  const flash_layout::Sector& sector = sector_of(slot);
  return {reinterpret_cast<const std::uint8_t*>(std::uintptr_t{sector.address}), sector.size};
}

image::Place image_place() {
  return {board::id, board::revision, image_body, flash_layout::max_image_size - image::header_size};
}

void start_program() {
  // The caches may hold data of an earlier program (RM0090, section 3.5.2). They are off after a reset.
  flash_interface::acr.set(flash_interface::acr_icrst | flash_interface::acr_dcrst);
  flash_interface::acr.clear(flash_interface::acr_icrst | flash_interface::acr_dcrst);
  jump_to(image_body);
}

}  // namespace proleg::stm32f405
