#pragma once

// Adafruit Feather STM32F405 Express: no transceiver, and USART2 ends on the board (PA3 measures the battery). The pins
// are those of the board's definitions in CircuitPython, MicroPython and Zephyr; names as printed on the board: D9 and
// D10 are CAN, A1 is the servo, TX, RX, SCK and MI are the touch sensors, A4 is the potentiometer.

#include "firmware/stm32f405/boards/profile.hpp"

namespace proleg::stm32f405::boards {

inline constexpr BoardProfile feather_stm32f405{
    .id = 4,
    .revision = 1,
    .crystal = 12'000'000,
    .can_receive = {'B', 8},
    .can_transmit = {'B', 9},
    .servo = {'A', 5},
    .contacts = {{{'B', 10}, {'B', 11}, {'B', 13}, {'B', 14}}},
    .servo_supply = {},
    .servo_current = {},
    .feedback = Pin{'C', 4},
    .console_transmit = {},
    .console_receive = {},
    .led = Switch{{'C', 1}, ActiveLevel::high},
    .recover_button = {},
};

}  // namespace proleg::stm32f405::boards
