#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

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
