#pragma once

#include "firmware/module/timeout.hpp"

namespace proleg::firmware {

/// Notices that SYNC is missing, or comes too early to be a tick.
class SyncWatch {
 public:
  /// Silence of SYNC that leads to a quick stop.
  static constexpr Microseconds timeout_us = 500'000;

  void stop() {
    timeout_.stop();
    has_tick_ = false;
  }
  /// After each event: whether SYNC is expected. The timeout starts when it is expected from now on.
  void update(Microseconds now, bool is_expected) {
    if (!is_expected) {
      timeout_.stop();
    } else if (!timeout_.is_running()) {
      timeout_.start(now, timeout_us);
    }
  }
  /// How much too early a SYNC is that comes now, in us; 0 if it is not: a tick lasts half of its period at least. Two
  /// producers cannot drive the robot faster, nor SYNCs that waited for the bus.
  [[nodiscard]] std::uint32_t early_us(Microseconds now, std::uint32_t tick_period_us) const {
    const Microseconds earliest = has_tick_ ? last_tick_at_ + tick_period_us / 2 : 0;
    return now < earliest ? static_cast<std::uint32_t>(earliest - now) : 0;
  }
  /// A SYNC was received that is a tick.
  void note_tick(Microseconds now) {
    has_tick_ = true;
    last_tick_at_ = now;
    restart(now);
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
  bool has_tick_ = false;
  Microseconds last_tick_at_ = 0;
};

}  // namespace proleg::firmware
