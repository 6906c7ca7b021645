#pragma once

#include <atomic>

#include "firmware/stm32f405/registers/supply.hpp"

namespace proleg::stm32f405 {

/// The voltage detector (RM0090, section 5.2.3), which watches the chip's supply of 3.3 V. Its threshold falls to 2.93
/// V and rises to 3.03 V (data sheet, embedded reset and power control block: typical; 2.84 V at least). Below 2.7 V
/// the flash needs more wait states than it has at 168 MHz (RM0090, table 10).
class Supply {
 public:
  void start();

  /// Whether the voltage was too low since the last call, for any length of time.
  [[nodiscard]] bool take_drop() {
    const bool has_dropped = has_dropped_.load(std::memory_order_relaxed);
    if (has_dropped) {
      has_dropped_.store(false, std::memory_order_relaxed);
    }
    return has_dropped;
  }
  [[nodiscard]] static bool is_low() { return pwr::csr.has(pwr::csr_pvdo); }

  /// Must be called by the interrupt. It comes at both edges; the rising one is needed, because the interrupt may come
  /// late for the falling one.
  void on_interrupt() {
    exti::pr.write(exti::line_pvd);
    has_dropped_.store(true, std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> has_dropped_{false};
};

}  // namespace proleg::stm32f405
