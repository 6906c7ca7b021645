#pragma once

// The use of the flash (docs/board.md). The linker script has the same addresses for what is linked.

#include <cstdint>

namespace proleg::stm32f405::flash_layout {

/// Sectors 1 and 2, 16 KiB each: the log of board records (firmware/module/board_record.hpp).
inline constexpr std::uint32_t board_records = 0x0800'4000;
/// Sectors 5 to 7: the image, with its vector table first.
inline constexpr std::uint32_t slot_a = 0x0802'0000;
inline constexpr std::uint32_t slot_size = 384 * 1024;

}  // namespace proleg::stm32f405::flash_layout
