#pragma once

// DMA2 (RM0090, section 10), stream 0 with channel 0: from ADC1 into memory, halfword by halfword, in a circle. Other
// streams, directions and sizes, the FIFO and interrupts are rejected.

#include <functional>
#include <span>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Dma final : public RegisterBlock {
 public:
  using WriteMemory = std::function<void(std::uint32_t address, std::span<const std::uint8_t> bytes)>;

  Dma(ChipServices& chip, WriteMemory write_memory);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] bool is_idle() const override { return !enabled(); }

  /// ADC1 requests the transfer of its data register. False: the stream is off, and the ADC waits.
  [[nodiscard]] bool transfer(std::uint16_t data);

 private:
  [[nodiscard]] bool enabled() const { return (control_ & 1U) != 0; }
  void write_control(std::uint32_t value);

  WriteMemory write_memory_;
  std::uint32_t flags_ = 0;
  std::uint32_t control_ = 0;
  std::uint32_t count_ = 0;   ///< NDTR: transfers until the end of the buffer
  std::uint32_t length_ = 0;  ///< NDTR as it was written
  std::uint32_t peripheral_ = 0;
  std::uint32_t memory_ = 0;
};

}  // namespace proleg::sim
