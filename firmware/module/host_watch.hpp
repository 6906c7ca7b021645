#pragma once

#include "firmware/module/timeout.hpp"

namespace proleg::firmware {

/// Notices that the heartbeat of the host is missing (CiA 301, consumer heartbeat time, object 0x1016).
class HostWatch {
 public:
  /// Sets the value of 0x1016: 65536 * node + timeout in ms; 0 ms: no heartbeat is expected. None is missing before the
  /// first heartbeat was received or the servo was enabled.
  void set(std::uint32_t expected) {
    expected_ = expected;
    timeout_.stop();
    is_enabled_ = false;
  }
  [[nodiscard]] std::uint32_t expected() const { return expected_; }
  [[nodiscard]] bool expects_heartbeat() const { return (expected_ & 0xFFFFU) != 0; }

  /// Takes a heartbeat of any node. Returns whether it is the one that is expected.
  bool receive_heartbeat(Microseconds now, std::uint8_t node) {
    const bool is_expected = expects_heartbeat() && node == expected_ >> 16U;
    if (is_expected) {
      start(now);
    }
    return is_expected;
  }
  /// Must be called after each event. is_enabled: whether the servo is. A host that enables it and stops before its
  /// first heartbeat is noticed, too.
  void update(Microseconds now, bool is_enabled) {
    if (is_enabled && !is_enabled_ && !timeout_.is_running()) {
      start(now);
    }
    is_enabled_ = is_enabled;
  }
  /// True once when the timeout has passed.
  [[nodiscard]] bool poll_timeout(Microseconds now) { return timeout_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_.deadline(); }

 private:
  void start(Microseconds now) {
    if (const std::uint32_t timeout_ms = expected_ & 0xFFFFU; timeout_ms != 0) {
      timeout_.start(now, Microseconds{timeout_ms} * 1'000U);
    }
  }

  std::uint32_t expected_ = 0;
  bool is_enabled_ = false;
  Timeout timeout_;
};

}  // namespace proleg::firmware
