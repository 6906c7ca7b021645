#pragma once

// The data that the maker of the chip has written into its system memory.

#include <array>

#include "firmware/stm32f405/readings.hpp"
#include "firmware/stm32f405/registers/register.hpp"

namespace proleg::stm32f405::factory {

/// The unique id: 96 bits, different in each chip; the lowest word first (RM0090, section 39.1).
[[nodiscard]] inline std::array<std::uint32_t, 3> unique_id() {
  constexpr std::uintptr_t at = 0x1FFF'7A10;
  return {Register(at).read(), Register(at + 4).read(), Register(at + 8).read()};
}

/// Calibration of the temperature sensor (data sheet, table 70).
[[nodiscard]] inline TemperatureCalibration temperature_calibration() {
  constexpr std::uintptr_t at = 0x1FFF'7A2C;  // 30 degrees in the lower half of the word, 110 in the upper
  const std::uint32_t both = Register(at).read();
  return {static_cast<std::uint16_t>(both), static_cast<std::uint16_t>(both >> 16U)};
}

}  // namespace proleg::stm32f405::factory
