#pragma once

// WeAct Studio STM32F4 64-pin core board with an STM32F405RGT6: no transceiver. The pins are those of the maker's
// repository (WeActStudio.STM32F4_64Pin_CoreBoard: mpconfigboard.h) and of the board's definition in Zephyr.

#include "firmware/stm32f405/boards/profile.hpp"

namespace proleg::stm32f405::boards {

inline constexpr BoardProfile weact_stm32f405{
    .id = 3,
    .revision = 1,
    .crystal = 8'000'000,
    .can_receive = {'B', 8},
    .can_transmit = {'B', 9},
    .servo = {'A', 5},
    .contacts = {{{'B', 12}, {'B', 13}, {'B', 14}, {'B', 15}}},
    .servo_supply = {},
    .servo_current = {},
    .feedback = Pin{'C', 1},
    .console_transmit = Pin{'A', 2},
    .console_receive = Pin{'A', 3},
    .led = Switch{{'B', 2}, ActiveLevel::high},
    .recover_button = Switch{{'C', 13}, ActiveLevel::high},
};

}  // namespace proleg::stm32f405::boards
