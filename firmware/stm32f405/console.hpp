#pragma once

#include <string_view>

#include "firmware/stm32f405/event_ring.hpp"

namespace proleg::stm32f405 {

/// Text for people on USART2. A text that finds no room is dropped: the program never waits for a
/// console.
class Console {
 public:
  /// peripheral_hz: PCLK1. baud: board::console_baud; of a gateway the baud rate of its line, so that one terminal
  /// reads both.
  void start(std::uint32_t peripheral_hz, std::uint32_t baud);

  // To be called at one priority, below that of USART2's interrupt.
  void write(std::string_view text);
  /// Eight digits.
  void write_hex(std::uint32_t value);
  void write_decimal(std::uint32_t value);

  /// Whether the last text has left the chip.
  [[nodiscard]] bool is_idle() const;

  void on_interrupt();
  /// Sends pending text and waits until that is done; needs no interrupt. For a program that cannot continue.
  void flush();

 private:
  EventRing<char, 512> pending_;
};

}  // namespace proleg::stm32f405
