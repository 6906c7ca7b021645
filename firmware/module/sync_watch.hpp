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
  /// Must be called after each event. is_expected: whether SYNC is; the timeout starts when it becomes true.
  void update(Microseconds now, bool is_expected) {
    if (!is_expected) {
      timeout_.stop();
    } else if (!timeout_.is_running()) {
      timeout_.start(now, timeout_us);
    }
  }
  /// Time by which a SYNC that comes now is too early [us]; 0 if it is not. A tick lasts at least half of its period,
  /// so that neither two producers nor SYNCs that waited for the bus drive the robot faster.
  [[nodiscard]] std::uint32_t early_us(Microseconds now, std::uint32_t tick_period_us) const {
    const Microseconds earliest = has_tick_ ? last_tick_at_ + tick_period_us / 2 : 0;
    return now < earliest ? static_cast<std::uint32_t>(earliest - now) : 0;
  }
  /// Must be called when a SYNC was received that is a tick.
  void note_tick(Microseconds now) {
    has_tick_ = true;
    last_tick_at_ = now;
    restart(now);
  }
  /// Must be called when any SYNC was received.
  void restart(Microseconds now) {
    if (timeout_.is_running()) {
      timeout_.start(now, timeout_us);
    }
  }
  /// True once when the timeout has passed.
  [[nodiscard]] bool poll_timeout(Microseconds now) { return timeout_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const { return timeout_.deadline(); }

 private:
  Timeout timeout_;
  bool has_tick_ = false;
  Microseconds last_tick_at_ = 0;
};

}  // namespace proleg::firmware
