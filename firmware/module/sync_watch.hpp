#pragma once

#include "firmware/module/timeout.hpp"

namespace proleg::firmware {

/// Notices that SYNC is missing.
class SyncWatch {
 public:
  /// Silence of SYNC that leads to a quick stop.
  static constexpr Microseconds timeout_us = 500'000;

  void stop() { timeout_.stop(); }
  /// After each event: whether SYNC is expected. The timeout starts when it is expected from now on.
  void update(Microseconds now, bool is_expected) {
    if (!is_expected) {
      timeout_.stop();
    } else if (!timeout_.is_running()) {
      timeout_.start(now, timeout_us);
    }
  }
  /// A SYNC was received.
  void restart(Microseconds now) {
    if (timeout_.is_running()) {
      timeout_.start(now, timeout_us);
    }
  }
  /// True, once, when the timeout has passed.
  [[nodiscard]] bool poll_timeout(Microseconds now) { return timeout_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_.deadline(); }

 private:
  Timeout timeout_;
};

}  // namespace proleg::firmware
