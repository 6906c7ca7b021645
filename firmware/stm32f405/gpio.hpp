#pragma once

#include "firmware/stm32f405/pins.hpp"

namespace proleg::stm32f405 {

// Modes as in MODER and pulls as in PUPDR (RM0090, section 8.4).
enum class PinMode : std::uint8_t { input, output, alternate, analog };
enum class Pull : std::uint8_t { none, up, down };

void set_mode(Pin pin, PinMode mode);
void set_pull(Pin pin, Pull pull);
/// Sets edges of 10 ns instead of 100 (data sheet, I/O AC characteristics, OSPEEDR = 01).
void set_fast_edges(Pin pin);
/// Selects the function for PinMode::alternate. function: AF0 to AF15, data sheet, table 9.
void connect_function(Pin pin, unsigned function);
/// Connects a pin with a peripheral. function: AF0 to AF15, data sheet, table 9.
void connect(Pin pin, unsigned function);
void set_low(Pin pin);

/// Enables the clocks of the ports and sets all pins of the board: the servo's pin is low, the others are inputs or
/// belong to their peripherals.
void start_pins();

}  // namespace proleg::stm32f405
