#pragma once

// The clocks of the chip, by crystal and PLL, and the module's own clock, which counts their microseconds.

#include <cstdint>

#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::stm32f405 {

enum class ClockResult : std::uint8_t {
  ok,
  no_crystal,  ///< the crystal (HSE) did not start
  no_pll,      ///< the PLL did not lock, or the clock did not switch to it
  no_supply,   ///< the supply is too low for the frequency (start_detector())
};

/// Switches the detector of the supply on (supply.hpp), and switches from the internal oscillator to the frequencies of
/// pins.hpp, by crystal and PLL. Always ends within 100 ms. If it fails, the chip stays on the internal oscillator,
/// which is too inaccurate for CAN at 1 Mbit/s. From now on a crystal that stops is a fault
/// (FaultRecord::Reason::crystal_stopped).
[[nodiscard]] ClockResult start_clocks();

/// Whether the clocks have the right frequency, as far as the chip can say: a PLL that has lost its lock runs on with
/// an unknown one, and raises no interrupt. Pulses and timeouts are wrong then, and a watchdog would be fed.
[[nodiscard]] inline bool is_pll_locked() { return rcc::cr.has(rcc::cr_pllrdy); }

/// The module's own clock (TIM5): microseconds since start(), on the crystal. Interrupts record the 32 bits of the
/// counter; the module's program extends them to 64. Only the priority of that program may call functions other than
/// stamp().
class MicrosecondClock {
 public:
  void start();

  /// The counter, which wraps after 71 minutes. Any priority may read it.
  [[nodiscard]] static std::uint32_t stamp() { return tim5.cnt().read(); }

  /// Time of a stamp that is at most half an hour old. Must be called at least every half hour.
  [[nodiscard]] Microseconds at(std::uint32_t stamp) {
    const auto since_latest = static_cast<std::int32_t>(stamp - static_cast<std::uint32_t>(latest_));
    const Microseconds time = latest_ + static_cast<Microseconds>(std::int64_t{since_latest});
    latest_ = since_latest > 0 ? time : latest_;
    return time;
  }
  [[nodiscard]] Microseconds now() { return at(stamp()); }

  /// Requests TIM5's interrupt at this time, at most half an hour from now. False if the time has passed; the interrupt
  /// may then not come.
  [[nodiscard]] static bool wake_at(Microseconds deadline) {
    const auto low = static_cast<std::uint32_t>(deadline);
    tim5.ccr1().write(low);
    // A match raises the interrupt from now on. This comparison finds a deadline that passed before.
    return static_cast<std::int32_t>(stamp() - low) < 0;
  }
  /// Must be called by the interrupt.
  static void on_interrupt() { tim5.sr().write(~Timer::sr_cc1if); }

 private:
  Microseconds latest_ = 0;
};

}  // namespace proleg::stm32f405
