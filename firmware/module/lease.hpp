#pragma once

#include "firmware/module/timeout.hpp"

namespace proleg::firmware {

/// The right of one session of a host to drive the robot: object 0x2002. Hosts take it before they change anything; the
/// module itself obeys every host. SDO does not name its sender, so a host writes its own random token and reads back
/// the token that has the lease.
class Lease {
 public:
  /// Silence of the host's heartbeat after which the lease is free again.
  static constexpr Microseconds timeout_us = 500'000;

  /// Returns to the state after power-on: the lease is free.
  void reset() { *this = {}; }
  /// The token of the session that has the lease; 0: none.
  [[nodiscard]] std::uint32_t token() const { return token_; }
  /// Compares and sets: false, without an effect, if another session has the lease.
  [[nodiscard]] bool take(Microseconds now, std::uint32_t token) {
    if (token_ != 0 && token_ != token) {
      return false;
    }
    token_ = token;
    renew(now);
    return true;
  }
  /// Must be called when the heartbeat of the host was received.
  void renew(Microseconds now) {
    if (token_ != 0) {
      timeout_.start(now, timeout_us);
    }
  }
  void poll(Microseconds now) {
    if (timeout_.poll(now)) {
      token_ = 0;
    }
  }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_.deadline(); }

 private:
  std::uint32_t token_ = 0;
  Timeout timeout_;
};

}  // namespace proleg::firmware
