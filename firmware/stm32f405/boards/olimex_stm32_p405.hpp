#pragma once

// Olimex STM32-P405: a CAN transceiver, an RS-232 driver at USART2, an LED and a button. The pins are those of the
// maker's user manual and of the board's definitions in Zephyr and RIOT. Zephyr calls the button active low, although
// it is the wake-up button, which the chip expects active high: docs/first-board.md says how to find out.

#include "firmware/stm32f405/boards/profile.hpp"

namespace proleg::stm32f405::boards {

inline constexpr BoardProfile olimex_stm32_p405{
    .id = 2,
    .revision = 1,
    .crystal = 8'000'000,
    .can_receive = {'B', 8},
    .can_transmit = {'B', 9},
    .servo = {'A', 5},
    .contacts = {{{'C', 6}, {'C', 7}, {'C', 8}, {'C', 9}}},  // PB12 to PB15 are the SD card's
    .servo_supply = {},
    .servo_current = {},
    .feedback = Pin{'C', 1},
    .console_transmit = Pin{'A', 2},
    .console_receive = Pin{'A', 3},
    .led = Switch{{'C', 12}, ActiveLevel::high},
    .recover_button = {},  // its active level is not certain, and a wrong one would keep the chip in the bootloader
};

}  // namespace proleg::stm32f405::boards
