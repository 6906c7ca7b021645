#pragma once

#include "firmware/module/module_identity.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"

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

/// Resets the chip as its reset pin does, except that RCC_CSR names software as the cause. RAM keeps its contents.
[[noreturn]] void reset_chip();

}  // namespace proleg::stm32f405
