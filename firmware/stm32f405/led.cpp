#include "firmware/stm32f405/led.hpp"

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/gpio.hpp"

namespace proleg::stm32f405 {

void show(LedPattern pattern, Microseconds now) {
  if constexpr (board::profile.led.has_value()) {
    switch_part(*board::profile.led, is_on(pattern, now));
  }
}

bool is_recover_button_held() {
  if constexpr (board::profile.recover_button.has_value()) {
    constexpr Switch button = board::profile.recover_button.value_or(Switch{});
    constexpr bool pressed_level = button.active == ActiveLevel::high;
    set_pull(button.pin, pressed_level ? Pull::down : Pull::up);
    // The pull charges the line through some 40 kOhm: 1 nF takes 0.1 ms. A read takes 5 cycles or more.
    constexpr std::uint32_t reads_in_100_us = board::internal_oscillator / 10'000 / 5;
    bool is_held = true;
    for (std::uint32_t reads = reads_in_100_us; reads != 0; --reads) {
      is_held = ((GpioPort(button.pin.port).idr().read() >> button.pin.number & 1U) != 0) == pressed_level;
    }
    set_pull(button.pin, Pull::none);
    return is_held;
  }
  return false;
}

}  // namespace proleg::stm32f405
