#pragma once

// The board for which the program is compiled: the use of its pins and the frequencies of its clocks, and the functions
// that set pins. PROLEG_BOARD, a definition of the compiler, is the board's name in the namespace boards
// (firmware/stm32f405/boards); without it: the reference board.

#include <array>
#include <cstdint>

#include "firmware/stm32f405/boards/boards.hpp"

#ifndef PROLEG_BOARD
#define PROLEG_BOARD reference
#endif

namespace proleg::stm32f405 {

namespace board {

inline constexpr const BoardProfile& profile = boards::PROLEG_BOARD;
inline constexpr std::uint16_t id = profile.id;
inline constexpr std::uint8_t revision = profile.revision;

// Clocks in Hz (RM0090, section 7.2). The limits are those of the data sheet.
inline constexpr std::uint32_t internal_oscillator = 16'000'000;  ///< HSI: the clock before the crystal has started
inline constexpr std::uint32_t core = clocks::core;
inline constexpr std::uint32_t apb1 = core / 4;         ///< clock of CAN1 and USART2; at most 42 MHz
inline constexpr std::uint32_t apb1_timers = 2 * apb1;  ///< clock of TIM2 and TIM5
inline constexpr std::uint32_t apb2 = core / 2;         ///< clock of ADC1; at most 84 MHz

inline constexpr Pin can_receive = profile.can_receive;
inline constexpr Pin can_transmit = profile.can_transmit;
inline constexpr Pin servo = profile.servo;
inline constexpr std::array<Pin, 4> contacts = profile.contacts;

// The alternate functions are the same at all pins that check_board() allows.
inline constexpr unsigned can_function = 9;
inline constexpr unsigned servo_function = 1;
inline constexpr unsigned console_function = 7;
inline constexpr std::uint32_t console_baud = 115'200;

/// Channel of the internal reference voltage, which is converted if nothing measures the current or the angle.
inline constexpr unsigned reference_channel = 17;
inline constexpr unsigned servo_current_channel =
    profile.servo_current ? analog_channel_of(*profile.servo_current) : reference_channel;
inline constexpr unsigned feedback_channel =
    profile.feedback ? analog_channel_of(*profile.feedback) : reference_channel;
inline constexpr unsigned temperature_channel = 16;  ///< channel of the sensor inside the chip
inline constexpr std::uint32_t vdda_millivolt = 3300;

}  // namespace board

// Modes as in MODER and pulls as in PUPDR (RM0090, section 8.4).
enum class PinMode : std::uint8_t { input, output, alternate, analog };
enum class Pull : std::uint8_t { none, up, down };

void set_mode(Pin pin, PinMode mode);
void set_pull(Pin pin, Pull pull);
/// Sets edges of 10 ns instead of 100 (data sheet, I/O AC characteristics, OSPEEDR = 01).
void set_fast_edges(Pin pin);
/// Selects the function for PinMode::alternate. function: AF0 to AF15, data sheet, table 9.
void connect_function(Pin pin, unsigned function);
/// Connects a pin with a peripheral. function: AF0 to AF15, data sheet, table 9.
void connect(Pin pin, unsigned function);
void set_high(Pin pin);
void set_low(Pin pin);
/// Sets the level at which a part is on, or the other one.
void switch_part(const Switch& part, bool is_on);
/// Switches the servo's supply. Without a switch for it nothing happens. It may be called before start_pins(), which
/// makes the pin an output and the supply off.
void switch_servo_supply(bool is_on);

/// Makes the servo's pin low, which floats from the reset on. Nothing else is needed before: it may be the first call.
void hold_servo_low();

/// Enables the clocks of the ports and sets all pins of the board: the servo's pin is low, the others are inputs or
/// belong to their peripherals.
void start_pins();

}  // namespace proleg::stm32f405
