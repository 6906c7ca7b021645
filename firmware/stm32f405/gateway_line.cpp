#include "firmware/stm32f405/gateway_line.hpp"

#include <array>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/dma.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/usart.hpp"

namespace proleg::stm32f405 {
namespace {

// Channels of the streams (RM0090, table 42).
constexpr unsigned channel = 4;
constexpr dma::Stream receive_stream(dma::dma1, 5);
constexpr dma::Stream transmit_stream(dma::dma1, 6);

/// Size of the ring: 5 ms of the line, longer than the program ever takes until it reads, except for an erase of flash.
constexpr std::size_t input_size = 512;
constexpr std::size_t output_size = 512;
// These buffers are not members: the driver's virtual table makes it initialized data, which the image in flash
// contains.
constinit std::array<char, input_size> input{};
constinit std::array<char, output_size> output{};

constexpr std::uint32_t receiving =
    dma::cr_channel(channel) | dma::cr_minc | dma::cr_circ | dma::cr_htie | dma::cr_tcie | dma::cr_en;
constexpr std::uint32_t sending =
    dma::cr_channel(channel) | dma::cr_minc | dma::cr_to_peripheral | dma::cr_tcie | dma::cr_en;
constexpr std::uint32_t on = usart2::cr1_ue | usart2::cr1_te | usart2::cr1_re | usart2::cr1_idleie;

/// Number of reads until a stream is off. It ends the transfer under way first, which takes a few cycles.
constexpr std::uint32_t reads_until_off = 100;

static_assert(board::apb1 % GatewayLine::baud == 0, "the baud rate is exact");

std::uint32_t address_of(const void* data) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(data));
}

}  // namespace

void GatewayLine::follow_console() {
  if (is_wanted_ == is_connected() || is_sending_ || !console_->is_idle()) {
    return;
  }
  if (is_wanted_) {
    start();
  } else {
    stop();
  }
}

void GatewayLine::start() {
  rcc::ahb1enr.set(rcc::ahb1enr_dma1);
  static_cast<void>(rcc::ahb1enr.read());
  usart2::cr1.write(0);
  usart2::brr.write(board::apb1 / baud);
  usart2::cr3.write(usart2::cr3_dmat | usart2::cr3_dmar | usart2::cr3_eie);
  receive_stream.par.write(usart2::dr_address);
  receive_stream.m0ar.write(address_of(input.data()));
  receive_stream.ndtr.write(input_size);
  receive_stream.clear_flags(dma::all_flags);
  receive_stream.cr.write(receiving);
  transmit_stream.par.write(usart2::dr_address);
  transmit_stream.m0ar.write(address_of(output.data()));
  read_position_ = 0;
  has_passed_half_ = false;
  has_passed_end_ = false;
  is_damaged_.store(false, std::memory_order_relaxed);
  is_connected_.store(true, std::memory_order_relaxed);
  usart2::cr1.write(on);
}

void GatewayLine::stop() {
  usart2::cr1.write(0);
  usart2::cr3.write(0);
  receive_stream.cr.write(0);
  static_cast<void>(wait_until_clear(receive_stream.cr, dma::cr_en, reads_until_off));
  is_connected_.store(false, std::memory_order_relaxed);
  console_->start(board::apb1, board::console_baud);
}

std::size_t GatewayLine::write_position() { return (input_size - receive_stream.ndtr.read()) % input_size; }

void GatewayLine::note_passes() {
  has_passed_half_ = has_passed_half_ || receive_stream.has(dma::flag_half);
  has_passed_end_ = has_passed_end_ || receive_stream.has(dma::flag_complete);
  receive_stream.clear_flags(dma::all_flags);
}

void GatewayLine::skip_input() {
  note_passes();
  read_position_ = write_position();
  has_passed_half_ = false;
  has_passed_end_ = false;
}

bool GatewayLine::take_damage() {
  if (!is_connected()) {
    return false;
  }
  note_passes();
  // A whole ring of characters passes the half and the end. The program reads in time, so this happens only after an
  // erase of flash.
  const bool is_overwritten = has_passed_half_ && has_passed_end_;
  const bool is_damaged = is_damaged_.exchange(false, std::memory_order_relaxed);
  if (is_overwritten || is_damaged) {
    skip_input();
  }
  return is_overwritten || is_damaged;
}

std::size_t GatewayLine::read_line(std::span<char> characters) {
  if (!is_connected()) {
    return 0;
  }
  const std::size_t end = write_position();
  std::atomic_signal_fence(std::memory_order_acquire);
  std::size_t count = 0;
  while (count < characters.size() && read_position_ != end) {
    characters[count++] = input[read_position_];
    read_position_ = (read_position_ + 1) % input_size;
  }
  if (read_position_ == end) {
    has_passed_half_ = false;
    has_passed_end_ = false;
  }
  return count;
}

std::span<char> GatewayLine::line_room() {
  return is_connected() && is_wanted_ && !is_sending_ ? std::span<char>(output) : std::span<char>();
}

void GatewayLine::send_line(std::size_t count) {
  if (count == 0) {
    return;
  }
  is_sending_ = true;
  transmit_stream.ndtr.write(static_cast<std::uint32_t>(count));
  transmit_stream.clear_flags(dma::all_flags);
  usart2::sr.write(~usart2::sr_tc);  // makes is_idle() of the console right
  std::atomic_signal_fence(std::memory_order_release);
  transmit_stream.cr.write(sending);
}

void GatewayLine::on_line_interrupt() {
  const std::uint32_t status = usart2::sr.read();
  if ((status & (usart2::sr_fe | usart2::sr_nf | usart2::sr_ore)) != 0) {
    is_damaged_.store(true, std::memory_order_relaxed);
  }
  // A read of DR clears the flags. If a character is there, DMA reads it, and this read must not take it.
  if ((status & usart2::sr_rxne) == 0) {
    static_cast<void>(usart2::dr.read());
  }
}

void GatewayLine::on_receive_interrupt() { note_passes(); }

void GatewayLine::on_transmit_interrupt() {
  transmit_stream.clear_flags(dma::all_flags);
  is_sending_ = false;
}

}  // namespace proleg::stm32f405
