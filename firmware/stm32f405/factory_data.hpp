#pragma once

// The data that the maker of the chip has written into its system memory.

#include <array>

#include "firmware/stm32f405/readings.hpp"

namespace proleg::stm32f405::factory {

/// The unique id: 96 bits, different in each chip; the lowest word first (RM0090, section 39.1).
[[nodiscard]] std::array<std::uint32_t, 3> unique_id();

/// Calibration of the temperature sensor (data sheet, table 70).
[[nodiscard]] TemperatureCalibration temperature_calibration();

}  // namespace proleg::stm32f405::factory
