#pragma once

#include "firmware/stm32f405/registers/watchdog.hpp"

namespace proleg::stm32f405 {

/// Starts the independent watchdog, or changes its time, 1 to 2,000 ms. It resets the chip when it was not fed for this
/// time. Its clock is LSI: nominally 32 kHz, actually 17 to 47 kHz, so 200 ms are 136 to 376 (data sheet, table 36). It
/// cannot be stopped. False if it runs, but with the time that it had before, initially 512 ms.
[[nodiscard]] bool start_watchdog(std::uint32_t milliseconds);

[[gnu::always_inline]] inline void feed_watchdog() { iwdg::kr.write(iwdg::kr_feed); }

}  // namespace proleg::stm32f405
