#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/computer/master/sdo_transfer.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::test {

/// An SDO client that reads and writes numbers of at most four bytes. One attempt is made of each transfer.
class NumberTransfer {
 public:
  using State = canopen::SdoTransfer::State;
  static constexpr Microseconds default_timeout_us = canopen::SdoTransferOptions{}.timeout_us;

  /// Begins a read. Returns the request, which must be sent on the bus.
  [[nodiscard]] CanFrame read(Microseconds now, std::uint8_t node, canopen::Address address,
                              Microseconds timeout_us = default_timeout_us) {
    bytes_ = {};
    transfer_.upload(node, address, bytes_, options(timeout_us));
    return transfer_.next_frame(now).value();
  }
  /// Begins a write of `size` bytes, 1 to 4.
  [[nodiscard]] CanFrame write(Microseconds now, std::uint8_t node, canopen::Address address, std::uint8_t size,
                               std::uint32_t value, Microseconds timeout_us = default_timeout_us) {
    write_little_endian(bytes_, 0, size, value);
    transfer_.download(node, address, std::span(bytes_).first(size), options(timeout_us));
    return transfer_.next_frame(now).value();
  }

  /// Takes any frame from the bus. Returns whether it ended the transfer.
  bool receive(const CanFrame& frame) {
    const bool was_running = state() == State::running;
    transfer_.receive(0, frame);
    return was_running && state() != State::running;
  }
  void poll(Microseconds now) { transfer_.poll(now); }

  [[nodiscard]] Microseconds next_deadline() const { return transfer_.next_deadline(); }
  [[nodiscard]] State state() const { return transfer_.state(); }
  [[nodiscard]] canopen::AbortCode abort_code() const { return transfer_.abort_code(); }
  /// The value that was read, zero-extended from its size.
  [[nodiscard]] std::uint32_t value() const { return read_little_endian(bytes_, 0, 4); }
  [[nodiscard]] std::uint32_t size() const { return transfer_.size(); }

 private:
  static canopen::SdoTransferOptions options(Microseconds timeout_us) {
    canopen::SdoTransferOptions options;
    options.timeout_us = timeout_us;
    options.attempts = 1;
    return options;
  }

  std::array<std::uint8_t, 4> bytes_{};
  canopen::SdoTransfer transfer_;
};

}  // namespace proleg::test
