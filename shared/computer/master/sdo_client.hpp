#pragma once

// The client of expedited SDO transfers (CiA 301, section 7.2.4.3): four bytes at most, one request, one answer.

#include "shared/can/can_port.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

/// The client of one transfer at a time.
class SdoClient {
 public:
  static constexpr Microseconds default_timeout_us = 500'000;

  enum class State : std::uint8_t { idle, waiting, done, aborted };

  /// The request, to be sent on the bus. The deadline of the answer is now + timeout_us.
  [[nodiscard]] CanFrame read(Microseconds now, std::uint8_t node, Address address,
                              Microseconds timeout_us = default_timeout_us);
  /// size: 1, 2 or 4 bytes. The deadline is later for objects that need more time (min_write_timeout_us).
  [[nodiscard]] CanFrame write(Microseconds now, std::uint8_t node, Address address, std::uint8_t size,
                               std::uint32_t value, Microseconds timeout_us = default_timeout_us);

  /// Any frame from the bus. Returns whether it ended the transfer. It ignores an answer of another node, entry or kind
  /// of transfer. An answer that is not expedited ends it with `unknown_command`.
  bool receive(const CanFrame& frame);
  /// Ends the transfer with `timeout` if its deadline has passed.
  void poll(Microseconds now);
  /// When poll() must be called; `never` if no transfer is pending.
  [[nodiscard]] Microseconds next_deadline() const { return state_ == State::waiting ? deadline_ : never; }

  [[nodiscard]] State state() const { return state_; }
  /// After done: the value read, zero-extended from its size.
  [[nodiscard]] std::uint32_t value() const { return value_; }
  /// After done: the number of bytes read, 0 for a write.
  [[nodiscard]] std::uint8_t size() const { return size_; }
  /// After aborted: why.
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
