#pragma once

// What one start of the chip leaves for the next one: a few words at a fixed place of the RAM, which keeps its contents
// over a reset. The module's program and the bootloader have different RAM, except for these words.

#include <cstdint>

namespace proleg::stm32f405 {

enum class Handover : std::uint32_t {
  none = 0,
  stay = 0xB007'0001,      ///< the bootloader stays on the bus, though there is a program that may run
  start = 0xB007'0002,     ///< the bootloader starts the program in slot A; a start on trial has been counted
  pin_seen = 0xB007'0003,  ///< the reset pin was used a moment ago
};

/// What was left, once: then it is `none`. After power-on the RAM is arbitrary, which reads as `none`.
[[nodiscard]] Handover take_handover();
void leave_handover(Handover handover);

}  // namespace proleg::stm32f405
