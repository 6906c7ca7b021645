#pragma once

// What the program must know of the board around an STM32F405RG: its pins, its crystal, and what it has. Each board has
// a header of its own in this folder (docs/your-board.md). check_board() refuses to compile what the drivers or the
// chip cannot do.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "shared/image/board_names.hpp"

namespace proleg::stm32f405 {

struct Pin {
  char port = 0;  ///< 'A' to 'C' for a pin that a driver uses
  unsigned number = 0;

  friend constexpr bool operator==(const Pin&, const Pin&) = default;
};

/// The level at which an LED or a supply is on, or a button is pressed.
enum class ActiveLevel : std::uint8_t { low, high };

/// A pin to which an LED, a button or the switch of a supply is connected.
struct Switch {
  Pin pin;
  ActiveLevel active = ActiveLevel::high;
};

struct BoardProfile {
  std::uint16_t id = 0;       ///< of a row of image::board_names; no other board has it
  std::uint8_t revision = 0;  ///< revision of the hardware, which decides which images it can run
  std::uint32_t crystal = 0;  ///< Hz: 8, 12, 16 or 25 MHz
  Pin can_receive;            ///< CAN1: PB8 with PB9, or PA11 with PA12
  Pin can_transmit;
  Pin servo;  ///< output 1 of TIM2: PA0, PA5 or PA15
  /// Touch sensors: switches to ground, in the order of firmware::ContactPort: rear and front of the link behind the
  /// joint, rear and front of the link in front of it. All at one port, which is read at once.
  std::array<Pin, 4> contacts;
  std::optional<Switch> servo_supply;  ///< switches the servo's supply; the board keeps it off while the pin floats
  std::optional<Pin> servo_current;    ///< 1 V per A: PC0 to PC5; nothing: the board has no sensor
  std::optional<Pin> feedback;         ///< slider of a potentiometer between ground and VDDA: PC0 to PC5
  /// USART2: PA2 and PA3; nothing: the board leads them nowhere. It has no console then, and is no gateway.
  std::optional<Pin> console_transmit;
  std::optional<Pin> console_receive;
  std::optional<Switch> led;             ///< shows the state (docs/first-board.md)
  std::optional<Switch> recover_button;  ///< held during a reset (not by software): the bootloader stays
};

// Clocks in Hz (RM0090, section 7.2). All boards have the same ones behind the PLL. The limits are those of the data
// sheet.
namespace clocks {
inline constexpr std::uint32_t core = 168'000'000;
inline constexpr std::uint32_t usb = 48'000'000;
}  // namespace clocks

/// Factors of the PLL.
struct PllFactors {
  std::uint32_t m = 0;
  std::uint32_t n = 0;
  std::uint32_t p = 0;
  std::uint32_t q = 0;
};

/// The factors that make clocks::core of a crystal. The input of the PLL must be 1 to 2 MHz, where 2 gives the least
/// jitter, the VCO 100 to 432 MHz (RM0090, section 7.3.2); Q gives 48 MHz. All 0 if there are none.
[[nodiscard]] constexpr PllFactors pll_factors_of(std::uint32_t crystal) {
  constexpr std::uint32_t p = 2;
  constexpr std::uint32_t vco = clocks::core * p;
  constexpr std::uint32_t max_input = 2'000'000;
  constexpr std::uint32_t min_input = 1'000'000;
  for (std::uint32_t input = max_input; input >= min_input; input -= min_input) {
    if (crystal != 0 && crystal % input == 0 && vco % input == 0) {
      return {crystal / input, vco / input, p, vco / clocks::usb};
    }
  }
  return {};
}

/// Number of the analog channel of a pin of port C: ADC123_IN10 to IN15 are PC0 to PC5 (data sheet, table 7).
[[nodiscard]] constexpr unsigned analog_channel_of(Pin pin) {
  constexpr unsigned first_channel = 10;
  return first_channel + pin.number;
}

namespace board_rules {

[[nodiscard]] constexpr bool has_crystal(std::uint32_t crystal) {
  return crystal == 8'000'000 || crystal == 12'000'000 || crystal == 16'000'000 || crystal == 25'000'000;
}

[[nodiscard]] constexpr bool is_can_pair(Pin receive, Pin transmit) {
  return (receive == Pin{'B', 8} && transmit == Pin{'B', 9}) || (receive == Pin{'A', 11} && transmit == Pin{'A', 12});
}

[[nodiscard]] constexpr bool is_servo_pin(Pin pin) {
  return pin == Pin{'A', 0} || pin == Pin{'A', 5} || pin == Pin{'A', 15};
}

/// Whether a pin, if there is one, can be measured by the driver of the ADC.
[[nodiscard]] constexpr bool is_analog(const std::optional<Pin>& pin) {
  return !pin || (pin->port == 'C' && pin->number <= 5);
}

[[nodiscard]] constexpr bool is_console(const std::optional<Pin>& transmit, const std::optional<Pin>& receive) {
  return (!transmit && !receive) || (transmit == Pin{'A', 2} && receive == Pin{'A', 3});
}

/// All pins that a profile uses; those that it does not use are without a port.
[[nodiscard]] constexpr std::array<Pin, 14> pins_of(const BoardProfile& board) {
  const auto pin_of = [](const std::optional<Switch>& part) { return part ? part->pin : Pin{}; };
  return {board.can_receive,
          board.can_transmit,
          board.servo,
          board.contacts[0],
          board.contacts[1],
          board.contacts[2],
          board.contacts[3],
          pin_of(board.servo_supply),
          board.servo_current.value_or(Pin{}),
          board.feedback.value_or(Pin{}),
          board.console_transmit.value_or(Pin{}),
          board.console_receive.value_or(Pin{}),
          pin_of(board.led),
          pin_of(board.recover_button)};
}

/// Whether all pins are at the ports A to C of the package with 64 pins, and none is the debugger's (PA13, PA14).
[[nodiscard]] constexpr bool has_package_pins(const BoardProfile& board) {
  return std::ranges::all_of(pins_of(board), [](Pin pin) {
    return pin.port == 0 ||
           (pin.port >= 'A' && pin.port <= 'C' && pin.number < 16 && pin != Pin{'A', 13} && pin != Pin{'A', 14});
  });
}

[[nodiscard]] constexpr bool uses_pins_once(const BoardProfile& board) {
  const auto pins = pins_of(board);
  for (std::size_t i = 0; i < pins.size(); ++i) {
    if (pins[i].port != 0 && std::find(pins.begin() + i + 1, pins.end(), pins[i]) != pins.end()) {
      return false;
    }
  }
  return true;
}

[[nodiscard]] constexpr bool has_contacts_at_one_port(const BoardProfile& board) {
  return std::ranges::all_of(board.contacts,
                             [&board](Pin pin) { return pin.port != 0 && pin.port == board.contacts[0].port; });
}

}  // namespace board_rules

/// Compiles only if the chip and the drivers can do what the profile says. Always true.
template <const BoardProfile& board>
[[nodiscard]] consteval bool check_board() {
  static_assert(!image::board_name(board.id).empty(),
                "board profile: found an id without a name, expected one of shared/image/board_names.hpp");
  static_assert(board_rules::has_crystal(board.crystal),
                "board profile: found another crystal, expected 8, 12, 16 or 25 MHz, in Hz");
  static_assert(pll_factors_of(board.crystal).q != 0,
                "board profile: found a crystal of which the PLL makes no 168 MHz, expected one with such factors");
  static_assert(
      board_rules::is_can_pair(board.can_receive, board.can_transmit),
      "board profile: found no pins of CAN1, expected can_receive PB8 with can_transmit PB9, or PA11 with PA12");
  static_assert(
      board_rules::is_servo_pin(board.servo),
      "board profile: found no pin of the servo's timer, expected PA0, PA5 or PA15, which are TIM2 channel 1");
  static_assert(board_rules::has_contacts_at_one_port(board),
                "board profile: found touch sensors at no port or at several, expected four pins of one port");
  static_assert(board_rules::is_analog(board.servo_current) && board_rules::is_analog(board.feedback),
                "board profile: found servo_current or feedback at another pin, expected PC0 to PC5 or no pin");
  static_assert(board_rules::is_console(board.console_transmit, board.console_receive),
                "board profile: found other pins of the console, expected PA2 and PA3, which are USART2, or no pins");
  static_assert(board_rules::has_package_pins(board),
                "board profile: found a pin that a module cannot use, expected ports A to C without PA13 and PA14");
  static_assert(board_rules::uses_pins_once(board),
                "board profile: found a pin that is used twice, expected each pin once");
  return true;
}

}  // namespace proleg::stm32f405
