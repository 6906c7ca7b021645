#pragma once

namespace proleg::stm32f405 {

/// As after a reset by the pin, except that RCC_CSR says that software did it. RAM keeps its contents.
[[noreturn]] void reset_chip();

}  // namespace proleg::stm32f405
