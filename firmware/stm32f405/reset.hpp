#pragma once

namespace proleg::stm32f405 {

/// Resets the chip as its reset pin does, except that RCC_CSR names software as the cause. RAM keeps its contents.
[[noreturn]] void reset_chip();

}  // namespace proleg::stm32f405
