#pragma once

// The use of the flash (docs/board.md). The linker script has the same addresses for the parts that are linked.

#include <cstdint>

#include "shared/image/image_header.hpp"

namespace proleg::stm32f405::flash_layout {

/// Sectors 0 and 1, 16 KiB each: the bootloader. The chip starts from the first.
inline constexpr std::uint32_t bootloader = 0x0800'0000;
inline constexpr std::uint32_t bootloader_size = 2 * 16 * 1024;
/// Sectors 2 and 3, 16 KiB each: the log of board records (firmware/module/board_record.hpp).
inline constexpr unsigned first_sector_of_records = 2;
inline constexpr std::uint32_t board_records = 0x0800'8000;
inline constexpr std::uint32_t board_records_size = 2 * 16 * 1024;
/// Sectors 5 to 7: the image. Its header comes first, then the body, with the vector table first.
inline constexpr std::uint32_t slot_a = 0x0802'0000;
inline constexpr std::uint32_t slot_size = 384 * 1024;
inline constexpr std::uint32_t image_body = slot_a + image::header_size;

/// A part of the flash that is erased as a whole.
struct Sector {
  unsigned number = 0;
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};

/// The slots of the bootloader (firmware/bootloader/slots.hpp). An image is much smaller than one of these sectors.
inline constexpr Sector image_sector_a{5, slot_a, 128 * 1024};
inline constexpr Sector image_sector_b{8, 0x0808'0000, 128 * 1024};
/// Sector 4: the records of what the module trusts (firmware/bootloader/trust_store.hpp). It is never erased.
inline constexpr Sector trust_sector{4, 0x0801'0000, 64 * 1024};
/// Greatest size of an image, with its header.
inline constexpr std::uint32_t max_image_size = 88 * 1024;

}  // namespace proleg::stm32f405::flash_layout
