#pragma once

namespace proleg::stm32f405 {

/// Serves the bus until the chip is to be reset. The clocks run, and TIM5. Does not return.
[[noreturn]] void serve_bus();

}  // namespace proleg::stm32f405
