#include "sim/mcu/peripherals/dma.hpp"

#include <string>
#include <utility>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t lisr = 0x00;
constexpr std::uint32_t hisr = 0x04;
constexpr std::uint32_t lifcr = 0x08;
constexpr std::uint32_t hifcr = 0x0C;
// Registers of stream 0; those of stream n lie n * stream_bytes further on.
constexpr std::uint32_t cr = 0x10;
constexpr std::uint32_t ndtr = 0x14;
constexpr std::uint32_t par = 0x18;
constexpr std::uint32_t m0ar = 0x1C;
constexpr std::uint32_t m1ar = 0x20;
constexpr std::uint32_t fcr = 0x24;
constexpr std::uint32_t stream_bytes = 0x18;
constexpr std::uint32_t end_of_streams = cr + Dma::stream_count * stream_bytes;

constexpr RegisterName registers[] = {
    {lisr, "LISR"},  {hisr, "HISR"},   {lifcr, "LIFCR"}, {hifcr, "HIFCR"}, {0x10, "S0CR"}, {0x14, "S0NDTR"},
    {0x18, "S0PAR"}, {0x1C, "S0M0AR"}, {0x20, "S0M1AR"}, {0x24, "S0FCR"},  {0x28, "S1CR"}, {0x2C, "S1NDTR"},
    {0x30, "S1PAR"}, {0x34, "S1M0AR"}, {0x38, "S1M1AR"}, {0x3C, "S1FCR"},  {0x40, "S2CR"}, {0x44, "S2NDTR"},
    {0x48, "S2PAR"}, {0x4C, "S2M0AR"}, {0x50, "S2M1AR"}, {0x54, "S2FCR"},  {0x58, "S3CR"}, {0x5C, "S3NDTR"},
    {0x60, "S3PAR"}, {0x64, "S3M0AR"}, {0x68, "S3M1AR"}, {0x6C, "S3FCR"},  {0x70, "S4CR"}, {0x74, "S4NDTR"},
    {0x78, "S4PAR"}, {0x7C, "S4M0AR"}, {0x80, "S4M1AR"}, {0x84, "S4FCR"},  {0x88, "S5CR"}, {0x8C, "S5NDTR"},
    {0x90, "S5PAR"}, {0x94, "S5M0AR"}, {0x98, "S5M1AR"}, {0x9C, "S5FCR"},  {0xA0, "S6CR"}, {0xA4, "S6NDTR"},
    {0xA8, "S6PAR"}, {0xAC, "S6M0AR"}, {0xB0, "S6M1AR"}, {0xB4, "S6FCR"},  {0xB8, "S7CR"}, {0xBC, "S7NDTR"},
    {0xC0, "S7PAR"}, {0xC4, "S7M0AR"}, {0xC8, "S7M1AR"}, {0xCC, "S7FCR"}};

constexpr std::uint32_t cr_en = 1U << 0U;
constexpr std::uint32_t cr_teie = 1U << 2U;
constexpr std::uint32_t cr_errors = 3U << 1U;  ///< DMEIE, TEIE; the error of the direct mode does not occur here
constexpr std::uint32_t cr_htie = 1U << 3U;
constexpr std::uint32_t cr_tcie = 1U << 4U;
constexpr std::uint32_t cr_to_peripheral = 1U << 6U;
constexpr std::uint32_t cr_circ = 1U << 8U;
constexpr std::uint32_t cr_minc = 1U << 10U;
constexpr std::uint32_t cr_halfwords = 1U << 11U | 1U << 13U;  ///< PSIZE, MSIZE
constexpr std::uint32_t cr_priority = 3U << 16U;
constexpr unsigned channel_shift = 25;
constexpr std::uint32_t cr_channel = 7U << channel_shift;
constexpr std::uint32_t cr_free = cr_en | cr_errors | cr_htie | cr_tcie | cr_circ | cr_priority;

constexpr std::uint32_t flag_error = 1U << 3U;
constexpr std::uint32_t flag_half = 1U << 4U;
constexpr std::uint32_t flag_complete = 1U << 5U;
constexpr std::uint32_t all_flags = 0x3D;
constexpr std::uint32_t fcr_reset = 0x21;

/// Position of a stream's flags in its status register (RM0090, 10.5.1).
constexpr unsigned flag_shift(unsigned stream) {
  constexpr std::array<unsigned, 4> shifts{0, 6, 16, 22};
  return shifts.at(stream % 4);
}

std::array<InterruptLine, Dma::stream_count> interrupt_lines(ChipServices& chip, unsigned number) {
  // Positions of the streams' interrupts (RM0090, table 61), for DMA1 and DMA2.
  constexpr std::array<std::array<unsigned, Dma::stream_count>, 2> positions{
      {{11, 12, 13, 14, 15, 16, 17, 47}, {56, 57, 58, 59, 60, 68, 69, 70}}};
  const auto& of = positions.at(number - 1);
  return {InterruptLine(chip, of[0]), InterruptLine(chip, of[1]), InterruptLine(chip, of[2]),
          InterruptLine(chip, of[3]), InterruptLine(chip, of[4]), InterruptLine(chip, of[5]),
          InterruptLine(chip, of[6]), InterruptLine(chip, of[7])};
}

}  // namespace

Dma::Dma(ChipServices& chip, unsigned number, Memory memory)
    : RegisterBlock(chip, number == 1 ? "DMA1" : "DMA2", number == 1 ? 0x4002'6000 : 0x4002'6400, 0x400, registers),
      memory_(std::move(memory)),
      interrupts_(interrupt_lines(chip, number)) {}

void Dma::connect(const Connection& connection, DmaPeripheral& peripheral) {
  Stream& stream = streams_.at(connection.stream);
  stream.connection = connection;
  stream.peripheral = &peripheral;
}

void Dma::reset() {
  for (Stream& stream : streams_) {
    const Stream connected{.connection = stream.connection, .peripheral = stream.peripheral};
    stream = connected;
  }
  flags_ = {};
  for (unsigned number = 0; number < stream_count; ++number) {
    update_interrupt(number);
  }
}

bool Dma::is_idle() const {
  for (const Stream& stream : streams_) {
    if (stream.enabled()) {
      return false;
    }
  }
  return true;
}

void Dma::serve(unsigned number) {
  Stream& stream = streams_.at(number);
  while (stream.enabled() && stream.peripheral->requests_dma()) {
    transfer(stream);
    if (stream.count == stream.length / 2) {
      raise(number, flag_half);
    }
    if (stream.count == 0) {
      if ((stream.control & cr_circ) != 0) {
        stream.count = stream.length;
      } else {
        stream.control &= ~cr_en;
      }
      raise(number, flag_complete);
    }
  }
}

void Dma::fail(unsigned number) {
  Stream& stream = streams_.at(number);
  if (stream.enabled()) {
    stream.control &= ~cr_en;
    raise(number, flag_error);
  }
}

void Dma::transfer(Stream& stream) {
  const unsigned bytes = stream.connection->bytes;
  const std::uint32_t address = stream.memory_address + bytes * (stream.length - stream.count);
  std::array<std::uint8_t, 2> data{};
  const std::span<std::uint8_t> used = std::span(data).first(bytes);
  if (stream.connection->direction == Direction::from_peripheral) {
    const std::uint16_t value = stream.peripheral->dma_read();
    data = {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)};
    memory_.write(address, used);
  } else {
    memory_.read(address, used);
    stream.peripheral->dma_write(static_cast<std::uint16_t>(data[0] | unsigned{data[1]} << 8U));
  }
  --stream.count;
}

void Dma::raise(unsigned number, std::uint32_t flag) {
  flags_.at(number / 4) |= flag << flag_shift(number);
  update_interrupt(number);
}

void Dma::update_interrupt(unsigned number) {
  const std::uint32_t flags = flags_.at(number / 4) >> flag_shift(number);
  const std::uint32_t control = streams_.at(number).control;
  interrupts_.at(number).set(((flags & flag_error) != 0 && (control & cr_teie) != 0) ||
                             ((flags & flag_half) != 0 && (control & cr_htie) != 0) ||
                             ((flags & flag_complete) != 0 && (control & cr_tcie) != 0));
}

std::uint32_t Dma::read(std::uint32_t offset) {
  switch (offset) {
    case lisr:
      return flags_[0];
    case hisr:
      return flags_[1];
    case lifcr:
    case hifcr:
      return 0;
    default:
      break;
  }
  if (offset < cr || offset >= end_of_streams) {
    reject_read(offset);
  }
  const Stream& stream = streams_.at((offset - cr) / stream_bytes);
  switch (cr + (offset - cr) % stream_bytes) {
    case cr:
      return stream.control;
    case ndtr:
      return stream.count;
    case par:
      return stream.peripheral_address;
    case m0ar:
      return stream.memory_address;
    case m1ar:
      return 0;
    case fcr:
      return fcr_reset;
    default:
      reject_read(offset);
  }
}

void Dma::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == lifcr || offset == hifcr) {
    const unsigned first = offset == lifcr ? 0 : 4;
    flags_.at(first / 4) &= ~value;
    for (unsigned number = first; number < first + 4; ++number) {
      update_interrupt(number);
    }
  } else if (offset >= cr && offset < end_of_streams) {
    write_stream((offset - cr) / stream_bytes, offset, value);
  } else {
    reject_write(offset, value);
  }
}

void Dma::write_stream(unsigned number, std::uint32_t offset, std::uint32_t value) {
  Stream& stream = streams_.at(number);
  const std::uint32_t place = cr + (offset - cr) % stream_bytes;
  if (stream.enabled() && (place == ndtr || place == par || place == m0ar)) {
    reject_write(offset, value, "the stream is enabled (RM0090, 10.5)");
  }
  switch (place) {
    case cr:
      write_control(number, offset, value);
      break;
    case ndtr:
      stream.length = value & 0xFFFFU;
      stream.count = stream.length;
      break;
    case par:
      stream.peripheral_address = value;
      break;
    case m0ar:
      stream.memory_address = value;
      break;
    default:
      reject_write(offset, value, "double buffers and the FIFO are not modelled");
  }
}

void Dma::write_control(unsigned number, std::uint32_t offset, std::uint32_t value) {
  Stream& stream = streams_.at(number);
  const bool was_enabled = stream.enabled();
  if ((value & cr_en) != 0) {
    if (was_enabled && ((value ^ stream.control) & ~(cr_errors | cr_htie | cr_tcie)) != 0) {
      reject_write(offset, value, "the stream is enabled (RM0090, 10.5.5)");
    }
    check_enable(stream, number, offset, value);
  }
  stream.control = value;
  update_interrupt(number);
  if (stream.enabled() && !was_enabled) {
    stream.peripheral->dma_starts();
    serve(number);
  }
}

void Dma::check_enable(const Stream& stream, unsigned number, std::uint32_t offset, std::uint32_t value) const {
  const auto& connection = stream.connection;
  if (!connection || connection->channel != (value & cr_channel) >> channel_shift) {
    reject_write(offset, value,
                 "channel " + std::to_string((value & cr_channel) >> channel_shift) + " of stream " +
                     std::to_string(number) + " is not modelled");
  }
  const bool to_peripheral = connection->direction == Direction::to_peripheral;
  const std::uint32_t wanted =
      cr_minc | (connection->bytes == 2 ? cr_halfwords : 0U) | (to_peripheral ? cr_to_peripheral : 0U);
  if ((value & ~(cr_free | cr_channel)) != wanted || (to_peripheral && (value & cr_circ) != 0)) {
    reject_write(offset, value,
                 std::string("only ") + (connection->bytes == 2 ? "halfwords " : "bytes ") +
                     (to_peripheral ? "out of memory, once," : "into memory") + " are modelled");
  }
  const std::uint64_t end = std::uint64_t{stream.memory_address} + connection->bytes * std::uint64_t{stream.length};
  if (stream.peripheral_address != connection->data_register || stream.count == 0 ||
      stream.memory_address % connection->bytes != 0 || stream.memory_address < ChipMemory::ram_start ||
      end > ChipMemory::ram_start + ChipMemory::ram_size) {
    reject_write(offset, value, "only the peripheral's data register and a buffer in RAM are modelled");
  }
  if (!stream.enabled() && ((flags_.at(number / 4) >> flag_shift(number)) & all_flags) != 0) {
    reject_write(offset, value, "flags of the transfer before are set (RM0090, 10.3.17)");
  }
}

}  // namespace proleg::sim
