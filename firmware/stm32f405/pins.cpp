#include "firmware/stm32f405/pins.hpp"

#include "firmware/stm32f405/registers/gpio.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"

namespace proleg::stm32f405 {

void set_mode(Pin pin, PinMode mode) {
  const unsigned shift = 2 * pin.number;
  GpioPort(pin.port).moder().change(3U << shift, static_cast<std::uint32_t>(mode) << shift);
}

void set_pull(Pin pin, Pull pull) {
  const unsigned shift = 2 * pin.number;
  GpioPort(pin.port).pupdr().change(3U << shift, static_cast<std::uint32_t>(pull) << shift);
}

void set_fast_edges(Pin pin) {
  const unsigned shift = 2 * pin.number;
  GpioPort(pin.port).ospeedr().change(3U << shift, 1U << shift);
}

void connect_function(Pin pin, unsigned function) {
  const unsigned shift = 4 * (pin.number % 8);
  GpioPort(pin.port).afr(pin.number).change(15U << shift, function << shift);
}

void connect(Pin pin, unsigned function) {
  connect_function(pin, function);
  set_mode(pin, PinMode::alternate);
}

void set_high(Pin pin) { GpioPort(pin.port).bsrr().write(1U << pin.number); }

void set_low(Pin pin) { GpioPort(pin.port).bsrr().write(1U << (pin.number + 16U)); }

void switch_part(const Switch& part, bool is_on) {
  if (is_on == (part.active == ActiveLevel::high)) {
    set_high(part.pin);
  } else {
    set_low(part.pin);
  }
}

void switch_servo_supply(bool is_on) {
  if constexpr (board::profile.servo_supply.has_value()) {
    switch_part(*board::profile.servo_supply, is_on);
  }
}

namespace {

void enable_ports() {
  rcc::ahb1enr.set(rcc::ahb1enr_gpioa | rcc::ahb1enr_gpiob | rcc::ahb1enr_gpioc);
  static_cast<void>(rcc::ahb1enr.read());  // the clock starts two cycles later (RM0090, section 7.2.13)
}

}  // namespace

void hold_servo_low() {
  enable_ports();
  set_low(board::servo);
  set_mode(board::servo, PinMode::output);
}

void start_pins() {
  hold_servo_low();
  if constexpr (board::profile.servo_supply.has_value()) {
    switch_servo_supply(false);
    set_mode(board::profile.servo_supply->pin, PinMode::output);
  }
  for (const Pin pin : board::contacts) {
    set_pull(pin, Pull::up);
    set_mode(pin, PinMode::input);
  }
  // The input is pulled up, so that the bus looks idle on a board without a transceiver.
  set_pull(board::can_receive, Pull::up);
  // A bit of 1 us leaves no time for slow edges.
  set_fast_edges(board::can_transmit);
  connect(board::can_receive, board::can_function);
  connect(board::can_transmit, board::can_function);
  if constexpr (board::profile.console_receive.has_value()) {
    set_pull(*board::profile.console_receive, Pull::up);
    connect(*board::profile.console_receive, board::console_function);
    connect(*board::profile.console_transmit, board::console_function);
  }
  if constexpr (board::profile.led.has_value()) {
    set_mode(board::profile.led->pin, PinMode::output);
  }
  if constexpr (board::profile.servo_current.has_value()) {
    set_mode(*board::profile.servo_current, PinMode::analog);
  }
  if constexpr (board::profile.feedback.has_value()) {
    set_mode(*board::profile.feedback, PinMode::analog);
  }
}

}  // namespace proleg::stm32f405
