#pragma once

#include <cstdint>

namespace proleg::sim {

/// Time on a chip's own crystal since its power-on, in units of 1/1008 us. Every clock that this chip family uses (HSI
/// 16 MHz, HSE 8 MHz, 168, 84, 42, 48 MHz ...) divides 1,008 MHz, so that periods are whole numbers and nothing is
/// rounded.
using LocalTime = std::uint64_t;
inline constexpr LocalTime local_time_per_us = 1008;
/// An event that never comes.
inline constexpr LocalTime never_on_chip = ~LocalTime{0};

/// Periods of a chip's clocks, as RCC has set them (RM0090, section 7). At reset: HSI.
struct Clocks {
  static constexpr LocalTime hsi = local_time_per_us / 16;
  LocalTime core = hsi;         ///< HCLK: one instruction takes one of these
  LocalTime apb1 = hsi;         ///< CAN1, USART2
  LocalTime apb2 = hsi;         ///< ADC1
  LocalTime apb1_timers = hsi;  ///< TIM2, TIM5
  LocalTime apb2_timers = hsi;
};

}  // namespace proleg::sim
