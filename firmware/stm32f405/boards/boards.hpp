#pragma once

// All boards, for the program, the programs of the host and the virtual chip. The build makes images for the boards
// whose headers are included here.

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/stm32f405/boards/feather_stm32f405.hpp"
#include "firmware/stm32f405/boards/olimex_stm32_p405.hpp"
#include "firmware/stm32f405/boards/reference.hpp"
#include "firmware/stm32f405/boards/weact_stm32f405.hpp"

namespace proleg::stm32f405::boards {

inline constexpr std::array<const BoardProfile*, 4> all{&reference, &olimex_stm32_p405, &weact_stm32f405,
                                                        &feather_stm32f405};

/// The board with an id; null if there is none.
[[nodiscard]] constexpr const BoardProfile* find(std::uint16_t id) {
  for (const BoardProfile* const board : all) {
    if (board->id == id) {
      return board;
    }
  }
  return nullptr;
}

namespace checks {

[[nodiscard]] consteval bool are_ids_unique() {
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (all[i]->id == all[j]->id) {
        return false;
      }
    }
  }
  return true;
}

static_assert(are_ids_unique(), "boards: found an id twice, expected each once");
static_assert(check_board<reference>());
static_assert(check_board<olimex_stm32_p405>());
static_assert(check_board<weact_stm32f405>());
static_assert(check_board<feather_stm32f405>());

}  // namespace checks
}  // namespace proleg::stm32f405::boards
