#pragma once

#include "firmware/stm32f405/pins.hpp"

namespace proleg::stm32f405 {

// As MODER and PUPDR have them (RM0090, section 8.4).
enum class PinMode : std::uint8_t { input, output, alternate, analog };
enum class Pull : std::uint8_t { none, up, down };

void set_mode(Pin pin, PinMode mode);
void set_pull(Pin pin, Pull pull);
/// Connects a pin with a peripheral. function: AF0 to AF15, data sheet, table 9.
void connect(Pin pin, unsigned function);
void set_low(Pin pin);

/// Clocks of the ports, and all pins of the board as they rest: the servo's low, the others as inputs or at their
/// peripherals.
void start_pins();

}  // namespace proleg::stm32f405
