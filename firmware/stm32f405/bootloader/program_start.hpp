#pragma once

#include "firmware/bootloader/slots.hpp"

namespace proleg::stm32f405 {

/// Board and place of images on the reference board.
[[nodiscard]] image::Place image_place();

/// Starts the program in slot A. The chip must be as after a reset, except for the watchdog.
[[noreturn]] void start_program();

}  // namespace proleg::stm32f405
