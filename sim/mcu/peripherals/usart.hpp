#pragma once

// USART2 (RM0090, section 30): asynchronous, 8 data bits, no parity, one stop bit; with DMA in both directions, idle
// line detection and framing errors. The noise flag is never set.

#include <cstdint>
#include <functional>
#include <optional>

#include "sim/mcu/peripherals/dma.hpp"
#include "sim/mcu/peripherals/register_block.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

class Usart final : public RegisterBlock {
 public:
  static constexpr unsigned number = 2;
  static constexpr unsigned interrupt_position = 38;

  /// dma: DMA1, which must outlive the USART; without DMA1 the use of DMA is rejected.
  Usart(ChipServices& chip, BoardSignals& board, Dma* dma = nullptr);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] LocalTime next_event() const override;
  void advance() override;
  void clocks_change(const Clocks& next) override;
  void clocks_fail(const Clocks& next) override;
  [[nodiscard]] bool is_idle() const override;

  /// A character begins on the line to the receiver at a time, with the sender's bit time. It is lost while the
  /// receiver is off.
  void begin_receive(LocalTime start, const SerialCharacter& character, LocalTime bit);
  /// Called with each byte that is sent, and the end of its stop bit, in addition to BoardSignals::serial_output().
  using OutputWatch = std::function<void(LocalTime end, std::uint8_t byte)>;
  void watch_output(OutputWatch watch) { output_watch_ = std::move(watch); }
  /// Duration of a bit in local time; nothing while BRR holds no baud rate.
  [[nodiscard]] std::optional<LocalTime> bit_time() const;

 private:
  /// The transmitter as a peripheral of the DMA; the receiver follows.
  struct TransmitRequest final : DmaPeripheral {
    explicit TransmitRequest(Usart& its_port) : port(its_port) {}
    [[nodiscard]] bool requests_dma() const override;
    void dma_write(std::uint16_t data) override { port.put_data(static_cast<std::uint8_t>(data)); }
    Usart& port;
  };
  struct ReceiveRequest final : DmaPeripheral {
    explicit ReceiveRequest(Usart& its_port) : port(its_port) {}
    [[nodiscard]] bool requests_dma() const override;
    [[nodiscard]] std::uint16_t dma_read() override { return port.take_data(); }
    Usart& port;
  };

  void settle();
  void settle_transmitter();
  void settle_receiver();
  void take_character(const SerialCharacter& character);
  void serve_dma();
  void put_data(std::uint8_t byte);
  [[nodiscard]] std::uint8_t take_data();
  [[nodiscard]] bool receives() const;
  [[nodiscard]] LocalTime frame_time() const;
  [[nodiscard]] bool sends() const { return frame_end_ != never_on_chip; }
  void write_cr1(std::uint32_t value);
  void check_divider(std::uint32_t divider, bool over8, std::uint32_t offset, std::uint32_t value) const;
  void write_brr(std::uint32_t value);
  void write_data(std::uint32_t value);
  void write_cr3(std::uint32_t value);
  void update_interrupt();

  BoardSignals* board_;
  Dma* dma_;
  TransmitRequest transmit_request_{*this};
  ReceiveRequest receive_request_{*this};
  OutputWatch output_watch_;
  InterruptLine interrupt_;
  std::uint32_t sr_ = 0;
  std::uint32_t brr_ = 0;
  std::uint32_t cr1_ = 0;
  std::uint32_t cr2_ = 0;
  std::uint32_t cr3_ = 0;
  std::uint32_t gtpr_ = 0;
  std::uint8_t received_ = 0;
  std::optional<std::uint8_t> waiting_;   ///< byte in the transmit data register
  std::optional<std::uint8_t> shifting_;  ///< byte in the shift register; nothing: an idle frame
  LocalTime frame_end_ = never_on_chip;
  SerialReceiver receiver_;
  /// Flags that a read of SR has found set; an access to DR clears them.
  std::uint32_t flags_read_ = 0;
};

}  // namespace proleg::sim
