#pragma once

// Resets of the chip: the cause of the last one, the program's own, and those by the independent watchdog.

#include "firmware/module/module_identity.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/watchdog.hpp"

namespace proleg::stm32f405 {

/// Cause of the chip's start, from RCC_CSR. The chip pulls its own reset pin at every reset, so that the pin's flag
/// counts only if it is the only one (RM0090, section 7.1.1).
[[nodiscard]] constexpr firmware::ResetCause reset_cause_of(std::uint32_t csr) {
  using firmware::ResetCause;
  if ((csr & (rcc::csr_porrstf | rcc::csr_borrstf)) != 0) {
    return ResetCause::power_on;
  }
  if ((csr & rcc::csr_iwdgrstf) != 0) {
    return ResetCause::watchdog;
  }
  return (csr & rcc::csr_sftrstf) != 0 ? ResetCause::software : ResetCause::pin;
}

/// Whether the supply has just come, or come back. Power on clears all flags but its own; they stay until the program
/// clears them (RM0090, section 7.3.21). So the flag of another cause shows a later reset. A reset by the pin adds no
/// flag: before the program has cleared them it counts as power on. The manual does not say whether a brown-out clears
/// the others: if it does not, one before the program has cleared them does not count.
[[nodiscard]] constexpr bool has_just_got_power(std::uint32_t csr) {
  return (csr & (rcc::csr_porrstf | rcc::csr_borrstf)) != 0 && (csr & (rcc::csr_sftrstf | rcc::csr_iwdgrstf)) == 0;
}

/// Resets the chip as its reset pin does, except that RCC_CSR names software as the cause. RAM keeps its contents.
[[noreturn]] void reset_chip();

/// Starts the independent watchdog, or changes its time, 1 to 2,000 ms. It resets the chip when it was not fed for this
/// time. Its clock is LSI: nominally 32 kHz, actually 17 to 47 kHz, so 200 ms are 136 to 376 (data sheet, table 36). It
/// cannot be stopped. False if it runs, but with the time that it had before, initially 512 ms.
[[nodiscard]] bool start_watchdog(std::uint32_t milliseconds);

/// Starts the watchdog's time again.
[[gnu::always_inline]] inline void feed_watchdog() { iwdg::kr.write(iwdg::kr_feed); }

}  // namespace proleg::stm32f405
