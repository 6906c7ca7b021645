#pragma once

#include <string_view>

#include "firmware/stm32f405/event_ring.hpp"

namespace proleg::stm32f405 {

/// Text for people on USART2. A text is dropped if there is no room for it: the program never waits for a console.
class Console {
 public:
  /// peripheral_hz: frequency of PCLK1. baud: board::console_baud; for a gateway the baud rate of its line, so that the
  /// same terminal reads both.
  void start(std::uint32_t peripheral_hz, std::uint32_t baud);

  // Functions for a single priority, below that of USART2's interrupt.
  void write(std::string_view text);
  /// Writes eight hexadecimal digits.
  void write_hex(std::uint32_t value);
  void write_decimal(std::uint32_t value);

  /// Whether the last text was sent completely.
  [[nodiscard]] bool is_idle() const;

  void on_interrupt();
  /// Sends pending text and waits until that is done; it needs no interrupt. It is for a program that cannot continue.
  void flush();

 private:
  EventRing<char, 512> pending_;
};

}  // namespace proleg::stm32f405
