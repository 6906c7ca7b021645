#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// Brings the controller back from bus-off (ISO 11898-1, 6.13): asks it after a pause of 10 ms, and again after pauses
/// twice as long each, up to 1 s, so that a module that disturbs the bus does so less and less. The pauses are short
/// again when it stayed on the bus for 10 s.
class BusRecovery {
 public:
  static constexpr Microseconds shortest_pause_us = 10'000;
  static constexpr Microseconds longest_pause_us = 1'000'000;
  static constexpr Microseconds calm_us = 10'000'000;

  explicit BusRecovery(CanPort& port) : port_(port) {}

  /// On the bus, and nothing was ever wrong.
  void reset() {
    off_ = false;
    pause_us_ = shortest_pause_us;
    due_ = never;
  }

  [[nodiscard]] bool is_off() const { return off_; }
  void bus_off(Microseconds now) {
    off_ = true;
    off_since_ = now;
    due_ = now + pause_us_;
  }
  /// Returns how long it was off, in ms.
  std::uint32_t bus_back(Microseconds now) {
    off_ = false;
    due_ = now + calm_us;
    return static_cast<std::uint32_t>((now - off_since_) / 1'000U);
  }

  /// Asks the controller if that is due. True, once, when it has stayed on the bus for 10 s.
  [[nodiscard]] bool poll(Microseconds now) {
    if (now < due_) {
      return false;
    }
    if (!off_) {
      reset();
      return true;
    }
    port_.recover();
    pause_us_ = 2 * pause_us_ < longest_pause_us ? 2 * pause_us_ : longest_pause_us;
    due_ = now + pause_us_;
    return false;
  }
  [[nodiscard]] Microseconds next_deadline() const { return due_; }

 private:
  CanPort& port_;
  bool off_ = false;
  Microseconds off_since_ = 0;
  Microseconds pause_us_ = shortest_pause_us;  ///< before the next request
  Microseconds due_ = never;                   ///< off: the next request; on: the end of the 10 s
};

}  // namespace proleg::firmware
