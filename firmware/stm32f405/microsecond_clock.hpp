#pragma once

#include "firmware/stm32f405/registers/timer.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::stm32f405 {

/// The module's own clock (TIM5): microseconds since start(), on the crystal. The counter's 32 bits, which interrupts
/// note, become 64 where the module's program runs: everything but stamp() belongs to that one priority.
class MicrosecondClock {
 public:
  void start();

  /// The counter as it is now; comes round after 71 minutes. For any priority.
  [[nodiscard]] static std::uint32_t stamp() { return tim5.cnt().read(); }

  /// The time of a stamp that is not older than half an hour. Must be called once in half an hour or more often.
  [[nodiscard]] Microseconds at(std::uint32_t stamp) {
    const auto since_latest = static_cast<std::int32_t>(stamp - static_cast<std::uint32_t>(latest_));
    const Microseconds time = latest_ + static_cast<Microseconds>(std::int64_t{since_latest});
    latest_ = since_latest > 0 ? time : latest_;
    return time;
  }
  [[nodiscard]] Microseconds now() { return at(stamp()); }

  /// TIM5's interrupt comes at this time, at most half an hour away. False: that time has come already, and the
  /// interrupt may not come at all.
  [[nodiscard]] static bool wake_at(Microseconds deadline) {
    const auto low = static_cast<std::uint32_t>(deadline);
    tim5.ccr1().write(low);
    // From here on a match raises the interrupt. One that happened before, or could not because the counter was past
    // it, is seen here.
    return static_cast<std::int32_t>(stamp() - low) < 0;
  }
  /// To be called by the interrupt.
  static void on_interrupt() { tim5.sr().write(~Timer::sr_cc1if); }

 private:
  Microseconds latest_ = 0;
};

}  // namespace proleg::stm32f405
