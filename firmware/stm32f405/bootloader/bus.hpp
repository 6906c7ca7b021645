#pragma once

#include "firmware/bootloader/handover.hpp"

namespace proleg::stm32f405 {

/// Serves the bus until the chip must be reset. The clocks and TIM5 run. left: by the start before.
[[noreturn]] void serve_bus(const bootloader::Handover& left);

}  // namespace proleg::stm32f405
