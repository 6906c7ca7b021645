#pragma once

#include "firmware/module/timeout.hpp"

namespace proleg::firmware {

/// Notices that the heartbeat of the host is missing (CiA 301, consumer heartbeat time, object 0x1016).
class HostWatch {
 public:
  /// As in 0x1016: 65536 * node + timeout in ms; 0 ms: none is expected. Nothing is missing before the first heartbeat
  /// was received.
  void set(std::uint32_t expected) {
    expected_ = expected;
    timeout_.stop();
  }
  [[nodiscard]] std::uint32_t expected() const { return expected_; }

  /// A heartbeat of any node.
  void receive_heartbeat(Microseconds now, std::uint8_t node) {
    const std::uint32_t timeout_ms = expected_ & 0xFFFFU;
    if (timeout_ms != 0 && node == expected_ >> 16U) {
      timeout_.start(now, Microseconds{timeout_ms} * 1'000U);
    }
  }
  /// Whether a heartbeat of the host was received and the timeout has not passed since.
  [[nodiscard]] bool is_present() const { return timeout_.is_running(); }
  /// True, once, when the timeout has passed.
  [[nodiscard]] bool poll_timeout(Microseconds now) { return timeout_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_.deadline(); }

 private:
  std::uint32_t expected_ = 0;
  Timeout timeout_;
};

}  // namespace proleg::firmware
