#pragma once

#include <cstdint>

namespace proleg::stm32f405 {

enum class ClockResult : std::uint8_t {
  ok,
  no_crystal,  ///< the crystal (HSE) did not start
  no_pll,      ///< the PLL did not lock, or the clock did not switch to it
};

/// Switches from the internal oscillator to the frequencies of pins.hpp, by crystal and PLL. Always ends within 100 ms.
/// If it fails, the chip stays on the internal oscillator, which is too inaccurate for CAN at 1 Mbit/s. From now on a
/// crystal that stops is a fault (FaultRecord::Reason::crystal_stopped).
[[nodiscard]] ClockResult start_clocks();

}  // namespace proleg::stm32f405
