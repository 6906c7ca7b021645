#include "firmware/stm32f405/contacts.hpp"

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/gpio.hpp"

namespace proleg::stm32f405 {

std::uint8_t Contacts::read() {
  // All four inputs are read at once, so that they are from the same instant.
  constexpr unsigned first = board::contacts[0].number;
  static_assert(board::contacts[1].port == board::contacts[0].port && board::contacts[1].number == first + 1);
  static_assert(board::contacts[2].port == board::contacts[0].port && board::contacts[2].number == first + 2);
  static_assert(board::contacts[3].port == board::contacts[0].port && board::contacts[3].number == first + 3);
  constexpr std::uint32_t all = 15;
  return static_cast<std::uint8_t>(~(GpioPort(board::contacts[0].port).idr().read() >> first) & all);
}

}  // namespace proleg::stm32f405
