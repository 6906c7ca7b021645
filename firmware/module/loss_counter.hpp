#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// Counts received frames that were lost, and decides which losses are reported: on a bus that is too busy, reports
/// would cause more losses.
class LossCounter {
 public:
  static constexpr Microseconds pause_us = 1'000'000;

  /// count: losses since the start. Returns whether to report it: once a second at most.
  [[nodiscard]] bool add(Microseconds now, std::uint32_t count) {
    count_ = count;
    if (now < next_report_) {
      return false;
    }
    next_report_ = now + pause_us;
    return true;
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  std::uint32_t count_ = 0;
  Microseconds next_report_ = 0;
};

}  // namespace proleg::firmware
