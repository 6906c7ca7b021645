#pragma once

// DMA1 or DMA2 (RM0090, section 10) in direct mode, byte by byte or halfword by halfword, between a data register and a
// buffer in RAM: from the register, in a circle or once, or to it, once. The FIFO, double buffers, transfers from
// memory to memory, and channels to which no peripheral of this model is connected are rejected. A transfer takes no
// time.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

/// A peripheral whose data register a stream reads or writes.
class DmaPeripheral {
 public:
  /// Whether it requests a transfer now.
  [[nodiscard]] virtual bool requests_dma() const = 0;
  /// Transfers read the data register, or write it.
  [[nodiscard]] virtual std::uint16_t dma_read() { return 0; }
  virtual void dma_write(std::uint16_t /*data*/) {}
  /// Its stream was enabled.
  virtual void dma_starts() {}

 protected:
  ~DmaPeripheral() = default;
};

class Dma final : public RegisterBlock {
 public:
  struct Memory {
    std::function<void(std::uint32_t address, std::span<std::uint8_t> bytes)> read;
    std::function<void(std::uint32_t address, std::span<const std::uint8_t> bytes)> write;
  };
  static constexpr unsigned stream_count = 8;

  /// number: 1 or 2.
  Dma(ChipServices& chip, unsigned number, Memory memory);

  enum class Direction : std::uint8_t { from_peripheral, to_peripheral };
  /// A place in the manual's tables 42 and 43, and the data register of the peripheral there.
  struct Connection {
    unsigned stream;
    unsigned channel;
    Direction direction;
    unsigned bytes;               ///< bytes of a transfer: 1 or 2
    std::uint32_t data_register;  ///< its address
  };
  /// The peripheral must outlive this.
  void connect(const Connection& connection, DmaPeripheral& peripheral);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] bool is_idle() const override;

  /// To be called when a peripheral requests a transfer. Makes transfers while the peripheral requests them and its
  /// stream is enabled.
  void serve(unsigned stream);

  /// The stream's next transfer meets a bus error: it sets TEIF, and the stream is off (10.3.18).
  void fail(unsigned stream);

 private:
  struct Stream {
    std::uint32_t control = 0;
    std::uint32_t count = 0;   ///< NDTR: transfers until the end of the buffer
    std::uint32_t length = 0;  ///< NDTR as it was written
    std::uint32_t peripheral_address = 0;
    std::uint32_t memory_address = 0;
    std::optional<Connection> connection;
    DmaPeripheral* peripheral = nullptr;

    [[nodiscard]] bool enabled() const { return (control & 1U) != 0; }
  };

  void transfer(Stream& stream);
  void write_stream(unsigned number, std::uint32_t offset, std::uint32_t value);
  void write_control(unsigned number, std::uint32_t offset, std::uint32_t value);
  void check_enable(const Stream& stream, unsigned number, std::uint32_t offset, std::uint32_t value) const;
  void raise(unsigned number, std::uint32_t flag);
  void update_interrupt(unsigned number);

  Memory memory_;
  std::array<Stream, stream_count> streams_;
  std::array<std::uint32_t, 2> flags_{};  ///< LISR, HISR
  std::array<InterruptLine, stream_count> interrupts_;
};

}  // namespace proleg::sim
