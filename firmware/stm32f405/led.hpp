#pragma once

// The status LED and the button of boards that have them.

#include <cstdint>

#include "shared/can/can_port.hpp"

namespace proleg::stm32f405 {

/// What the LED shows: a bit for each twentieth of a second, the lowest first, then again from the start. The patterns
/// of the first four are those of CiA 303-3 (indicator of the state); the pauses between flashes are longer there by
/// less than half a second or shorter. A pattern stays the same to the eye on a board whose LED is connected the other
/// way round.
enum class LedPattern : std::uint32_t {
  bootloader = 0x5555'5555,       ///< flickers, ten times a second
  pre_operational = 0x0F0F'0F0F,  ///< blinks, two and a half times a second
  stopped = 0x0000'000F,          ///< one flash
  operational = 0xFFFF'FFFF,      ///< on
  fault = 0x0000'0F0F,            ///< two flashes: the drive is in Fault
};

/// Whether a pattern is on at a time.
[[nodiscard]] constexpr bool is_on(LedPattern pattern, Microseconds now) {
  constexpr Microseconds bit_us = 50'000;
  constexpr Microseconds bits = 32;
  // Without a division in the state in which the program runs most: one of 64 bits takes a tenth of the instructions
  // that a pulse takes.
  return pattern == LedPattern::operational ||
         ((static_cast<std::uint32_t>(pattern) >> (now / bit_us % bits)) & 1U) != 0;
}

/// Sets the LED as a pattern has it now. To be called every 50 ms or more often. Without an LED nothing happens.
void show(LedPattern pattern, Microseconds now);

/// Whether the button is held with which a person keeps the chip in the bootloader. False on a board without one. The
/// ports must have their clocks; the pin is as after a reset afterwards.
[[nodiscard]] bool is_recover_button_held();

}  // namespace proleg::stm32f405
