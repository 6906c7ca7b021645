#pragma once

#include <string_view>

#include "firmware/stm32f405/event_ring.hpp"

namespace proleg::stm32f405 {

/// Text for people, out of USART2 at 115,200 baud. A text that finds no room is dropped: nobody waits for a console.
class Console {
 public:
  /// peripheral_hz: PCLK1.
  void start(std::uint32_t peripheral_hz);

  // From one priority below USART2's interrupt.
  void write(std::string_view text);
  /// Eight digits.
  void write_hex(std::uint32_t value);
  void write_decimal(std::uint32_t value);

  void on_interrupt();
  /// Sends what is waiting without the interrupt, for one who can do nothing else any more.
  void flush();

 private:
  EventRing<char, 512> waiting_;
};

}  // namespace proleg::stm32f405
