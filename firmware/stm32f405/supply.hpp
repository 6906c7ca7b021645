#pragma once

// The chip's supply of 3.3 V, which its voltage detector (RM0090, section 5.2.3) compares with one threshold at a time.
// The thresholds are typical; they have a tolerance of 0.1 V, and a hysteresis of 0.1 V (data sheet, embedded reset and
// power control block).

#include <atomic>
#include <cstdint>

#include "firmware/stm32f405/registers/supply.hpp"

namespace proleg::stm32f405 {

/// Switches the detector on. Returns whether the voltage is above 2.60 V: the flash is then as fast as the clocks of
/// pins.hpp need it (clock.cpp), and it may fall for a while. From then on the threshold is 2.51 V.
[[nodiscard]] bool start_detector();

/// Whether the voltage is above 2.93 V, and the flash can be erased and programmed: words of 32 bits need 2.7 V
/// (RM0090, section 3.6.2). The detector must be on; the threshold that it has stays.
[[nodiscard]] bool is_flash_supplied();

/// Enables the interrupt of the detector, which comes when the voltage falls below its threshold and when it rises.
void enable_detector_interrupt();

/// What the supply allows a running program.
class Supply {
 public:
  enum class Level : std::uint8_t {
    good,  ///< above 3.03 V
    low,   ///< the servo must have no pulses
    none,  ///< below 2.60 V: the program must end before the voltage is too low for its clock
  };

  /// Watches for 2.93 V from now on. The detector must be on.
  void start();

  /// Whether the voltage was too low since the last call, for any length of time.
  [[nodiscard]] bool take_drop() {
    const bool has_dropped = has_dropped_.load(std::memory_order_relaxed);
    if (has_dropped) {
      has_dropped_.store(false, std::memory_order_relaxed);
    }
    return has_dropped;
  }

  /// Pause between two calls of look() while the voltage is low [us].
  static constexpr std::uint32_t look_every_us = 500;
  /// Must be called while the voltage is low, with MicrosecondClock::stamp(). Two thresholds take turns, so that it
  /// sees a change after 1 ms at most: the next higher one, at which the voltage is good again (a new threshold has no
  /// hysteresis), and the one at which the program must end. The last call returns good.
  [[nodiscard]] Level look(std::uint32_t stamp);

  /// Must be called by the interrupt. It comes at both edges; the rising one is needed, because the interrupt may come
  /// late for the falling one.
  void on_interrupt() {
    exti::pr.write(exti::line_pvd);
    has_dropped_.store(true, std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> has_dropped_{false};
  std::uint32_t threshold_ = pwr::cr_pls_2v8;
  std::uint32_t changed_at_ = 0;  ///< stamp of the last change of the threshold
};

}  // namespace proleg::stm32f405
