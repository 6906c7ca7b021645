#pragma once

// The data in system memory that distinguish chips (RM0090, section 39; DS8626).

#include <array>
#include <cstdint>
#include <string>

#include "sim/mcu/peripherals/adc.hpp"

namespace proleg::sim {

// Calibration values, converted at 3.3 V when the chip was made.
inline constexpr std::uint32_t vrefin_cal_address = 0x1FFF'7A2A;
inline constexpr std::uint32_t ts_cal1_address = 0x1FFF'7A2C;  ///< at 30 degrees Celsius
inline constexpr std::uint32_t ts_cal2_address = 0x1FFF'7A2E;  ///< at 110 degrees
inline constexpr std::uint16_t vrefin_cal = adc_code(vrefint_uv);
inline constexpr std::uint16_t ts_cal1 = adc_code(temperature_sensor_uv(30'000));
inline constexpr std::uint16_t ts_cal2 = adc_code(temperature_sensor_uv(110'000));

inline constexpr std::uint32_t unique_id_address = 0x1FFF'7A10;
inline constexpr std::uint32_t flash_kib_address = 0x1FFF'7A22;
inline constexpr std::uint16_t flash_kib = 1024;

/// System memory from this address on; the bytes that are not 0xFF: unique id, size of the flash, calibration.
inline constexpr std::uint32_t system_memory_address = 0x1FFF'7A00;
inline constexpr std::uint32_t system_memory_bytes = 0x30;
[[nodiscard]] std::array<std::uint8_t, system_memory_bytes> system_memory(
    const std::array<std::uint32_t, 3>& unique_id);

/// Describes an address that belongs to no peripheral of the model: "DMA1 at offset 0x10"; "0x40000C04" where the chip
/// has no peripheral (RM0090, table 1).
[[nodiscard]] std::string describe_address(std::uint32_t address);

}  // namespace proleg::sim
