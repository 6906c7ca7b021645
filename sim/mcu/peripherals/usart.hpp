#pragma once

// USART2 (RM0090, section 30): asynchronous, 8 data bits, no parity, one stop bit.

#include <cstdint>
#include <optional>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Usart final : public RegisterBlock {
 public:
  static constexpr unsigned number = 2;
  static constexpr unsigned interrupt_position = 38;

  Usart(ChipServices& chip, BoardSignals& board);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] LocalTime next_event() const override;
  void advance() override;
  void clocks_change(const Clocks& next) override;
  void clocks_fail(const Clocks& next) override;
  [[nodiscard]] bool is_idle() const override;

  /// A byte has arrived, at the end of its stop bit, which is now. Lost while the receiver is off.
  void receive(std::uint8_t byte);
  /// Local time of a bit; nothing while BRR holds no baud rate.
  [[nodiscard]] std::optional<LocalTime> bit_time() const;

 private:
  void settle();
  [[nodiscard]] LocalTime frame_time() const;
  [[nodiscard]] bool sends() const { return frame_end_ != never_on_chip; }
  void write_cr1(std::uint32_t value);
  void check_divider(std::uint32_t divider, bool over8, std::uint32_t offset, std::uint32_t value) const;
  void write_brr(std::uint32_t value);
  void write_data(std::uint32_t value);
  void update_interrupt();

  BoardSignals* board_;
  InterruptLine interrupt_;
  std::uint32_t sr_ = 0;
  std::uint32_t brr_ = 0;
  std::uint32_t cr1_ = 0;
  std::uint32_t cr2_ = 0;
  std::uint32_t cr3_ = 0;
  std::uint32_t gtpr_ = 0;
  std::uint8_t received_ = 0;
  std::optional<std::uint8_t> waiting_;   ///< in the transmit data register
  std::optional<std::uint8_t> shifting_;  ///< nothing: an idle frame
  LocalTime frame_end_ = never_on_chip;
  // Flags that a read of SR followed by an access to DR clears.
  bool tc_was_read_ = false;
  bool errors_were_read_ = false;
};

}  // namespace proleg::sim
