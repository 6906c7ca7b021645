#pragma once

#include "firmware/module/ports.hpp"

namespace proleg::stm32f405 {

/// Pulses of the servo: TIM2 at 12 MHz, channel 1, in PWM mode 1 (RM0090, section 18.3.9): the output is high while the
/// counter is below CCR1. A pulse begins when pulse() sets the counter to 0. If the program is late, the pulse is
/// repeated when the counter wraps, a quarter later than the period.
///
/// A width of 0 means no pulse: off() requests it, so that the last pulse ends with its width. A shortened pulse is a
/// command to another angle. After the first pulse the timer never stops.
///
/// From outside, pulses are recognised by CCER.CC1E = 1 while CCR1, the width that was requested last, is not 0.
class Servo final : public firmware::ServoPort {
 public:
  void start();
  /// width: 1 or more.
  void pulse(std::int32_t width, std::uint32_t period_us) override;
  void off() override;
  void switch_supply(bool is_on) override;
  /// Ends the running pulse with the width that was requested, also if the crystal has stopped; then the pin stays low,
  /// because the program cannot continue. Takes as long as the rest of the pulse, 2.5 ms at most. It may be called at
  /// any priority, also before start(), and with any contents of the RAM: what cannot be a width ends the pulse at
  /// once.
  void finish_last_pulse() const;

 private:
  void follow_timer();
  [[nodiscard]] bool continue_with_internal_oscillator() const;

  bool is_running_ = false;            ///< whether the timer runs: there was a pulse
  std::uint32_t requested_width_ = 0;  ///< the value in CCR1
  std::uint32_t last_count_ = 0;       ///< the value in ARR
  /// The width with which the timer compares: CCR1 at the last update event. It is volatile, and written before an
  /// event that the program causes, because finish_last_pulse() may run in between.
  volatile std::uint32_t active_width_ = 0;
};

}  // namespace proleg::stm32f405
