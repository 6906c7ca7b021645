#pragma once

// What a module does when a time has passed, or a message has not come for a time: heartbeat, lease, SYNC, and bus-off.

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// A wait that ends once. It does not run before start() is called.
class Timeout {
 public:
  /// Starts the wait, also again. duration_us: counted from now on.
  void start(Microseconds now, Microseconds duration_us) { ends_at_ = now + duration_us; }
  void stop() { ends_at_ = never; }
  [[nodiscard]] bool is_running() const { return ends_at_ != never; }
  /// True once when the duration has passed. Then the wait does not run any more.
  [[nodiscard]] bool poll(Microseconds now) {
    if (now < ends_at_) {
      return false;
    }
    ends_at_ = never;
    return true;
  }
  [[nodiscard]] Microseconds deadline() const { return ends_at_; }

 private:
  Microseconds ends_at_ = never;
};

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
  /// The node whose heartbeat is expected; 0: none.
  [[nodiscard]] std::uint8_t node() const {
    return expects_heartbeat() ? static_cast<std::uint8_t>(expected_ >> 16U) : std::uint8_t{0};
  }

  /// Takes a heartbeat of any node, 1 to 127. Returns whether it is the one that is expected.
  bool receive_heartbeat(Microseconds now, std::uint8_t sender) {
    const bool is_expected = sender == node();
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

/// Brings the controller back from bus-off (ISO 11898-1, 6.13). It asks the controller after a pause of 10 ms, then
/// after pauses twice as long each, up to 1 s, so that a module that disturbs the bus does so less and less often. The
/// pauses are short again after 10 s on the bus.
class BusRecovery {
 public:
  static constexpr Microseconds min_pause_us = 10'000;
  static constexpr Microseconds max_pause_us = 1'000'000;
  static constexpr Microseconds calm_us = 10'000'000;

  explicit BusRecovery(CanPort& port) : port_(port) {}

  /// Returns to the start: on the bus, with the shortest pause.
  void reset() {
    off_ = false;
    pause_us_ = min_pause_us;
    due_ = never;
  }

  [[nodiscard]] bool is_off() const { return off_; }
  void bus_off(Microseconds now) {
    off_ = true;
    off_since_ = now;
    due_ = now + pause_us_;
  }
  /// Must be called when the controller takes part again. Returns the time for which it was bus-off [ms].
  std::uint32_t bus_back(Microseconds now) {
    off_ = false;
    due_ = now + calm_us;
    return static_cast<std::uint32_t>((now - off_since_) / 1'000U);
  }

  /// Asks the controller if that is due. Returns true once, after 10 s on the bus.
  [[nodiscard]] bool poll(Microseconds now) {
    if (now < due_) {
      return false;
    }
    if (!off_) {
      reset();
      return true;
    }
    port_.recover();
    pause_us_ = 2 * pause_us_ < max_pause_us ? 2 * pause_us_ : max_pause_us;
    due_ = now + pause_us_;
    return false;
  }
  [[nodiscard]] Microseconds next_deadline() const { return due_; }

 private:
  CanPort& port_;
  bool off_ = false;
  Microseconds off_since_ = 0;
  Microseconds pause_us_ = min_pause_us;  ///< pause before the next request
  Microseconds due_ = never;              ///< bus-off: time of the next request; on the bus: end of the 10 s
};

}  // namespace proleg::firmware
