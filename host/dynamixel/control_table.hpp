#pragma once

// Control table of servos of the X series and of the MX series with Protocol 2.0 (ROBOTIS e-manual, "Control Table" of
// XL330-M288, XM430-W210 and MX-28(2.0), which agree on these items). Numbers are little-endian.

#include <cstdint>

namespace proleg::host {

/// An item, or neighbouring items that are read together.
struct TableItem {
  std::uint16_t address;
  std::uint16_t size;
};

// The items below are in the EEPROM, which can be written only while Torque Enable is 0.
inline constexpr TableItem return_delay_time{9, 1};  ///< 2 us; 0 to 254
inline constexpr TableItem drive_mode{10, 1};        ///< 0: normal direction, profile in velocities
inline constexpr TableItem operating_mode{11, 1};
inline constexpr TableItem homing_offset{20, 4};      ///< steps, signed; added to the position
inline constexpr TableItem min_voltage_limit{34, 2};  ///< 0.1 V
inline constexpr TableItem position_limits{48, 8};    ///< Max and Min Position Limit(48, 52), steps, read at once

// The items below are in the RAM.
inline constexpr TableItem torque_enable{64, 1};
inline constexpr TableItem status_return_level{68, 1};    ///< 2: all instructions are answered
inline constexpr TableItem bus_watchdog{98, 1};           ///< 20 ms; 0: off and clears its error; 255: it has stopped
inline constexpr TableItem profile_acceleration{108, 4};  ///< 0: none
inline constexpr TableItem profile_velocity{112, 4};      ///< 0.229 rev/min; 0: no bound
inline constexpr TableItem goal_position{116, 4};         ///< steps, within the position limits
inline constexpr TableItem present_position{132, 4};      ///< steps, signed

/// The items from Torque Enable(64) to Hardware Error Status(70), which are read at once.
inline constexpr TableItem torque_block{64, 7};
inline constexpr unsigned torque_in_block = 0;
inline constexpr unsigned hardware_error_in_block = 6;  ///< 0: none

/// Drive Mode(10) and Operating Mode(11), which are read at once.
inline constexpr TableItem mode_block{10, 2};

/// The items from Present Current(126) to Present Temperature(146), which are read at once.
inline constexpr TableItem present_block{126, 21};
/// Its first items, up to Present Position(132).
inline constexpr TableItem angle_block{126, 10};
inline constexpr unsigned current_in_block = 0;       ///< i16; mA, or 2.69 mA, or 0.1 % of the load: see the e-manual
inline constexpr unsigned position_in_block = 6;      ///< i32, steps
inline constexpr unsigned voltage_in_block = 18;      ///< u16, 0.1 V
inline constexpr unsigned temperature_in_block = 20;  ///< u8, degrees Celsius

inline constexpr std::uint8_t position_control_mode = 3;
inline constexpr std::uint8_t watchdog_has_stopped = 255;
inline constexpr unsigned watchdog_unit_ms = 20;
inline constexpr unsigned max_watchdog = 127;

/// A turn has 4096 steps; the middle position is 2048.
inline constexpr std::int32_t steps_per_turn = 4096;
inline constexpr std::int32_t middle_position = 2048;

inline constexpr double profile_velocity_unit_deg_s = 0.229 * 6.0;

/// Whether a servo with this Model Number(0) has the table above: X series 1000 to 1999, MX(2.0) 30, 311 and 321. The
/// XL-320 (350) and the P and PRO series (2000 and more, 35 thousand and more) have others.
[[nodiscard]] constexpr bool has_this_table(unsigned model) {
  return (model >= 1000 && model < 2000) || model == 30 || model == 311 || model == 321;
}

}  // namespace proleg::host
