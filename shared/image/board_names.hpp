#pragma once

// The boards that a module can have, by the id in the header of an image and in object 0x2000:4. The profiles of
// firmware/stm32f405/boards say what each board is.

#include <array>
#include <cstdint>
#include <string_view>

namespace proleg::image {

struct BoardName {
  std::uint16_t id = 0;
  std::string_view name;  ///< lower-case letters, digits and '-'; the folder of the board's images has it too
};

inline constexpr std::array<BoardName, 4> board_names{
    {{1, "reference"}, {2, "olimex-stm32-p405"}, {3, "weact-stm32f405"}, {4, "feather-stm32f405"}}};

/// The name of a board; empty for an id that this table does not have.
[[nodiscard]] constexpr std::string_view board_name(std::uint16_t id) {
  for (const BoardName& board : board_names) {
    if (board.id == id) {
      return board.name;
    }
  }
  return {};
}

// A bootloader names its board in a word of its vector table that ARM reserves (PM0214, table 17): the mark in the
// upper half, the id in the lower. The word of a bootloader before this rule, which is one for the reference board, is
// another.
inline constexpr std::uint32_t bootloader_board_at = 7 * 4;  ///< bytes from the beginning of the bootloader
inline constexpr std::uint32_t bootloader_board_mark = 0x5042'0000;

}  // namespace proleg::image
