#pragma once

#include <atomic>

#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/console.hpp"

namespace proleg::stm32f405 {

/// The gateway's serial line: USART2 at 1 Mbaud, with DMA in both directions. Received characters go into a ring; the
/// module's program runs when the line goes idle, and at each half of the ring. Characters to send are in a buffer; the
/// program runs when that is empty. So the CPU works a few times for each burst of characters, not for each character.
class GatewayLine final : public firmware::LinePort {
 public:
  static constexpr std::uint32_t baud = 1'000'000;

  explicit constexpr GatewayLine(Console& console) : console_(&console) {}

  // Functions of LinePort. Only code at the priority of the module's program may call them.
  void connect(bool is_gateway) override { is_wanted_ = is_gateway; }
  [[nodiscard]] std::size_t read_line(std::span<char> characters) override;
  [[nodiscard]] bool take_damage() override;
  [[nodiscard]] std::span<char> line_room() override;
  void send_line(std::size_t count) override;

  /// Takes the line over, or gives it back, when nothing is being sent. Must be called whenever the module's program
  /// runs.
  void follow_console();

  // Functions for the interrupts.
  [[nodiscard]] bool is_connected() const { return is_connected_.load(std::memory_order_relaxed); }
  /// Handles USART2: idle line or an error, while connected.
  void on_line_interrupt();
  /// Handles DMA: half of the ring is full, or all of it.
  void on_receive_interrupt();
  /// Handles the interrupt of the DMA after the last character was given to the USART, which still sends two.
  void on_transmit_interrupt();

 private:
  void start();
  void stop();
  [[nodiscard]] static std::size_t write_position();
  void note_passes();
  void skip_input();

  Console* console_;
  std::size_t read_position_ = 0;
  bool is_wanted_ = false;
  bool has_passed_half_ = false;  ///< the half of the ring was passed since the last read_line()
  bool has_passed_end_ = false;   ///< the end of the ring was passed since the last read_line()
  bool is_sending_ = false;
  std::atomic<bool> is_connected_{false};  ///< read by USART2's interrupt
  std::atomic<bool> is_damaged_{false};    ///< also set by USART2's interrupt
};

}  // namespace proleg::stm32f405
