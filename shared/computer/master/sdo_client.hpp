#pragma once

// The client of expedited SDO transfers (CiA 301, section 7.2.4.3): at most four bytes, one request, one answer.

#include "shared/can/can_port.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

/// The client of a single transfer.
class SdoClient {
 public:
  static constexpr Microseconds default_timeout_us = 500'000;

  enum class State : std::uint8_t { idle, waiting, done, aborted };

  /// Begins a read. Returns the request, which must be sent on the bus. The deadline of the answer is now + timeout_us.
  [[nodiscard]] CanFrame read(Microseconds now, std::uint8_t node, Address address,
                              Microseconds timeout_us = default_timeout_us);
  /// Begins a write of `size` bytes: 1, 2 or 4. The deadline is later for objects that need more time
  /// (min_write_timeout_us).
  [[nodiscard]] CanFrame write(Microseconds now, std::uint8_t node, Address address, std::uint8_t size,
                               std::uint32_t value, Microseconds timeout_us = default_timeout_us);

  /// Takes any frame from the bus. Returns whether it ended the transfer. The client ignores an answer of another node,
  /// entry or kind of transfer. An answer that is not expedited ends the transfer with `unknown_command`.
  bool receive(const CanFrame& frame);
  /// Ends the transfer with `timeout` if its deadline has passed.
  void poll(Microseconds now);
  /// Time at which poll() must be called; `never` if no transfer is pending.
  [[nodiscard]] Microseconds next_deadline() const { return state_ == State::waiting ? deadline_ : never; }

  [[nodiscard]] State state() const { return state_; }
  /// The value that was read, zero-extended from its size; valid in the state `done`.
  [[nodiscard]] std::uint32_t value() const { return value_; }
  /// The number of bytes that were read, 0 for a write; valid in the state `done`.
  [[nodiscard]] std::uint8_t size() const { return size_; }
  /// The reason of the abort; valid in the state `aborted`.
  [[nodiscard]] AbortCode abort_code() const { return abort_code_; }
  [[nodiscard]] std::uint8_t node() const { return node_; }
  [[nodiscard]] Address address() const { return address_; }

 private:
  CanFrame start(Microseconds now, std::uint8_t node, Address address, Microseconds timeout_us);
  bool finish(State state, AbortCode code);

  State state_ = State::idle;
  bool writing_ = false;
  std::uint8_t size_ = 0;
  std::uint8_t node_ = 0;
  Address address_;
  std::uint32_t value_ = 0;
  AbortCode abort_code_ = AbortCode::none;
  Microseconds deadline_ = 0;
};

}  // namespace proleg::canopen
