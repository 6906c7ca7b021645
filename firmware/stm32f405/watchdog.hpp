#pragma once

#include "firmware/stm32f405/registers/watchdog.hpp"

namespace proleg::stm32f405 {

/// The independent watchdog resets the chip when it was not fed for 200 ms, on a clock of its own (LSI: 32 kHz, in
/// truth 17 to 47 kHz, so 136 to 376 ms; data sheet, table 36). It cannot be stopped again. False: it runs, but with
/// the 512 ms that it has at first.
[[nodiscard]] bool start_watchdog();

[[gnu::always_inline]] inline void feed_watchdog() { iwdg::kr.write(iwdg::kr_feed); }

}  // namespace proleg::stm32f405
