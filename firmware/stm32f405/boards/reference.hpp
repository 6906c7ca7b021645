#pragma once

// The reference board (docs/board.md). The tables in firmware/stm32f405/board have its circuit, and their rules read
// this file.

#include "firmware/stm32f405/boards/profile.hpp"

namespace proleg::stm32f405::boards {

inline constexpr BoardProfile reference{
    .id = 1,
    .revision = 1,
    .crystal = 8'000'000,
    .can_receive = {'B', 8},
    .can_transmit = {'B', 9},
    .servo = {'A', 5},
    .contacts = {{{'B', 12}, {'B', 13}, {'B', 14}, {'B', 15}}},
    .servo_supply = Switch{{'C', 7}, ActiveLevel::high},
    .servo_current = Pin{'C', 0},
    .feedback = Pin{'C', 1},
    .console_transmit = Pin{'A', 2},
    .console_receive = Pin{'A', 3},
    .led = Switch{{'C', 6}, ActiveLevel::high},
    .recover_button = Switch{{'C', 13}, ActiveLevel::low},
};

}  // namespace proleg::stm32f405::boards
