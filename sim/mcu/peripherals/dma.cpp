#include "sim/mcu/peripherals/dma.hpp"

#include <array>

#include "sim/mcu/cpu/cpu.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t lisr = 0x00;
constexpr std::uint32_t hisr = 0x04;
constexpr std::uint32_t lifcr = 0x08;
constexpr std::uint32_t hifcr = 0x0C;
constexpr std::uint32_t s0cr = 0x10;
constexpr std::uint32_t s0ndtr = 0x14;
constexpr std::uint32_t s0par = 0x18;
constexpr std::uint32_t s0m0ar = 0x1C;
constexpr std::uint32_t s0m1ar = 0x20;
constexpr std::uint32_t s0fcr = 0x24;
constexpr RegisterName registers[] = {{lisr, "LISR"},     {hisr, "HISR"},     {lifcr, "LIFCR"}, {hifcr, "HIFCR"},
                                      {s0cr, "S0CR"},     {s0ndtr, "S0NDTR"}, {s0par, "S0PAR"}, {s0m0ar, "S0M0AR"},
                                      {s0m1ar, "S0M1AR"}, {s0fcr, "S0FCR"}};

constexpr std::uint32_t cr_en = 1U << 0U;
constexpr std::uint32_t cr_interrupts = 0x1EU;
constexpr std::uint32_t cr_priority = 3U << 16U;
/// CIRC, MINC, PSIZE and MSIZE of 16 bits, DIR from the peripheral, channel 0.
constexpr std::uint32_t cr_modelled = 1U << 8U | 1U << 10U | 1U << 11U | 1U << 13U;
constexpr std::uint32_t flag_half = 1U << 4U;
constexpr std::uint32_t flag_complete = 1U << 5U;
constexpr std::uint32_t fcr_reset = 0x21;
constexpr std::uint32_t adc1_dr = 0x4001'204C;

}  // namespace

Dma::Dma(ChipServices& chip, WriteMemory write_memory)
    : RegisterBlock(chip, "DMA2", 0x4002'6400, 0x400, registers), write_memory_(std::move(write_memory)) {}

void Dma::reset() {
  flags_ = 0;
  control_ = 0;
  count_ = 0;
  length_ = 0;
  peripheral_ = 0;
  memory_ = 0;
}

bool Dma::transfer(std::uint16_t data) {
  if (!enabled()) {
    return false;
  }
  const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(data), static_cast<std::uint8_t>(data >> 8U)};
  write_memory_(memory_ + 2 * (length_ - count_), bytes);
  --count_;
  if (count_ == length_ / 2) {
    flags_ |= flag_half;
  }
  if (count_ == 0) {
    flags_ |= flag_complete;
    count_ = length_;
  }
  return true;
}

std::uint32_t Dma::read(std::uint32_t offset) {
  switch (offset) {
    case lisr:
      return flags_;
    case hisr:
    case lifcr:
    case hifcr:
    case s0m1ar:
      return 0;
    case s0cr:
      return control_;
    case s0ndtr:
      return count_;
    case s0par:
      return peripheral_;
    case s0m0ar:
      return memory_;
    case s0fcr:
      return fcr_reset;
    default:
      reject_read(offset, "only stream 0 is modelled");
  }
}

void Dma::write(std::uint32_t offset, std::uint32_t value) {
  if (enabled() && (offset == s0ndtr || offset == s0par || offset == s0m0ar)) {
    reject_write(offset, value, "the stream is enabled (RM0090, 10.5)");
  }
  switch (offset) {
    case lifcr:
      flags_ &= ~value;
      break;
    case s0cr:
      write_control(value);
      break;
    case s0ndtr:
      length_ = value & 0xFFFFU;
      count_ = length_;
      break;
    case s0par:
      peripheral_ = value;
      break;
    case s0m0ar:
      memory_ = value;
      break;
    default:
      reject_write(offset, value, "only stream 0 from ADC1 is modelled");
  }
}

void Dma::write_control(std::uint32_t value) {
  reject_bits(s0cr, value, cr_interrupts, "its interrupts are not modelled");
  if ((value & cr_en) != 0) {
    if ((value & ~(cr_en | cr_priority)) != cr_modelled) {
      reject_write(s0cr, value, "only halfwords from channel 0 into memory, in a circle, are modelled");
    }
    const std::uint64_t end = std::uint64_t{memory_} + 2 * std::uint64_t{length_};
    if (peripheral_ != adc1_dr || length_ == 0 || memory_ % 2 != 0 || memory_ < Cpu::ram_start ||
        end > Cpu::ram_start + Cpu::ram_size) {
      reject_write(s0cr, value, "only from ADC1_DR into a buffer in RAM is modelled");
    }
    if (flags_ != 0 && !enabled()) {
      reject_write(s0cr, value, "flags of the transfer before are set (RM0090, 10.3.17)");
    }
  }
  control_ = value;
}

}  // namespace proleg::sim
