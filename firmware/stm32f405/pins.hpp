#pragma once

// The reference board, board id 1: the use of its pins and the frequencies of its clocks, as docs/board.md describes
// them, and the functions that set pins.

#include <array>
#include <cstdint>

namespace proleg::stm32f405 {

struct Pin {
  char port;
  unsigned number;
};

namespace board {

inline constexpr std::uint16_t id = 1;
inline constexpr std::uint8_t revision = 1;  ///< revision of the hardware, which decides which images it can run

// Clocks in Hz (RM0090, section 7.2). The limits are those of the data sheet.
inline constexpr std::uint32_t crystal = 8'000'000;
inline constexpr std::uint32_t internal_oscillator = 16'000'000;  ///< HSI: the clock before the crystal has started
inline constexpr std::uint32_t core = 168'000'000;
inline constexpr std::uint32_t apb1 = core / 4;         ///< clock of CAN1 and USART2; at most 42 MHz
inline constexpr std::uint32_t apb1_timers = 2 * apb1;  ///< clock of TIM2 and TIM5
inline constexpr std::uint32_t apb2 = core / 2;         ///< clock of ADC1; at most 84 MHz

inline constexpr Pin can_receive{'B', 8};
inline constexpr Pin can_transmit{'B', 9};
inline constexpr unsigned can_function = 9;

inline constexpr Pin servo{'A', 5};  ///< TIM2, channel 1
inline constexpr unsigned servo_function = 1;

/// Touch sensors: switches to ground, in the order of firmware::ContactPort: rear and front of the link behind the
/// joint, rear and front of the link in front of it.
inline constexpr std::array<Pin, 4> contacts{{{'B', 12}, {'B', 13}, {'B', 14}, {'B', 15}}};

inline constexpr Pin servo_current{'C', 0};  ///< 1 V per A
inline constexpr unsigned servo_current_channel = 10;
inline constexpr Pin feedback{'C', 1};  ///< slider of the potentiometer, between ground and VDDA
inline constexpr unsigned feedback_channel = 11;
inline constexpr unsigned temperature_channel = 16;  ///< channel of the sensor inside the chip
inline constexpr std::uint32_t vdda_millivolt = 3300;

inline constexpr Pin console_transmit{'A', 2};
inline constexpr Pin console_receive{'A', 3};
inline constexpr unsigned console_function = 7;
inline constexpr std::uint32_t console_baud = 115'200;

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
void set_low(Pin pin);

/// Makes the servo's pin low, which floats from the reset on. Nothing else is needed before: it may be the first call.
void hold_servo_low();

/// Enables the clocks of the ports and sets all pins of the board: the servo's pin is low, the others are inputs or
/// belong to their peripherals.
void start_pins();

}  // namespace proleg::stm32f405
