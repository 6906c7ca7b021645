#pragma once

// Conversion of readings of the ADC (12 bits, 0 to 4095 = VDDA) to physical values, in integers, rounded to nearest.

#include <algorithm>
#include <cstdint>

#include "firmware/module/board_record.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "shared/fixed/arithmetic.hpp"

namespace proleg::stm32f405 {

/// Servo current [mA].
[[nodiscard]] constexpr std::uint16_t current_of(std::uint32_t reading) {
  constexpr std::uint32_t milliampere_per_volt = 1000;
  constexpr auto full_scale = static_cast<std::int32_t>(board::vdda_millivolt * milliampere_per_volt / 1000);
  return static_cast<std::uint16_t>(
      divide_nearest(static_cast<std::int32_t>(reading) * full_scale, firmware::BoardRecord::max_reading));
}

/// Readings of the temperature sensor at 30 and 110 degrees Celsius and VDDA = 3.3 V, measured by the maker of each
/// chip (data sheet of the STM32F405, section 5.3.22).
struct TemperatureCalibration {
  std::uint16_t at_30 = 0;
  std::uint16_t at_110 = 0;
};

/// Temperature of the chip [degrees Celsius], on the line through the two points; -128 from a chip without calibration.
[[nodiscard]] constexpr std::int8_t temperature_of(std::uint32_t reading, TemperatureCalibration calibration) {
  constexpr std::int32_t min_temperature = -128;
  constexpr std::int32_t max_temperature = 127;
  const std::int32_t span = std::int32_t{calibration.at_110} - calibration.at_30;
  if (span <= 0) {
    return min_temperature;
  }
  const std::int32_t temperature =
      30 + divide_nearest((static_cast<std::int32_t>(reading) - calibration.at_30) * (110 - 30), span);
  return static_cast<std::int8_t>(std::clamp(temperature, min_temperature, max_temperature));
}

/// Angle of the joint (90 degrees = 2^30, saturating), on the line through the readings at -90 and +90 degrees. They
/// must differ; either may be higher.
[[nodiscard]] constexpr std::int32_t feedback_angle_of(std::uint32_t reading, std::uint16_t at_minus_90,
                                                       std::uint16_t at_plus_90) {
  constexpr std::int64_t right_angle = 1 << 30;
  constexpr std::int64_t min_angle = INT32_MIN;
  constexpr std::int64_t max_angle = INT32_MAX;
  std::int64_t span = std::int64_t{at_plus_90} - at_minus_90;
  std::int64_t way = std::int64_t{reading} - at_minus_90;
  if (span < 0) {
    span = -span;
    way = -way;
  }
  const std::int64_t angle = divide_nearest(way * 2 * right_angle, span) - right_angle;
  return static_cast<std::int32_t>(std::clamp(angle, min_angle, max_angle));
}

}  // namespace proleg::stm32f405
