#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// Notices that SYNC is missing.
class SyncWatch {
 public:
  /// Silence of SYNC that leads to a quick stop.
  static constexpr Microseconds timeout_us = 500'000;

  void stop() { timeout_at_ = never; }
  /// After each event: whether SYNC is expected. The timeout starts when it is expected from now on.
  void update(Microseconds now, bool is_expected) {
    if (!is_expected) {
      timeout_at_ = never;
    } else if (timeout_at_ == never) {
      timeout_at_ = now + timeout_us;
    }
  }
  /// A SYNC was received.
  void restart(Microseconds now) {
    if (timeout_at_ != never) {
      timeout_at_ = now + timeout_us;
    }
  }
  /// True, once, when the timeout has passed.
  [[nodiscard]] bool poll_timeout(Microseconds now) {
    if (now < timeout_at_) {
      return false;
    }
    timeout_at_ = never;
    return true;
  }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_at_; }

 private:
  Microseconds timeout_at_ = never;
};

}  // namespace proleg::firmware
