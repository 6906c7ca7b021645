#pragma once

#include "firmware/module/ports.hpp"

namespace proleg::stm32f405 {

/// Pulses of the servo: TIM2 at 12 MHz, channel 1, in PWM mode 1 (RM0090, section 18.3.9): the output is high while the
/// counter is below CCR1. A pulse begins when pulse() sets the counter to 0. If the program is late, the pulse is
/// repeated when the counter wraps, a quarter later than the period.
///
/// A pulse begins only after the output was low for 0.5 ms, whatever is requested when: two pulses that run together
/// are one long pulse for a servo. A request during that pause is kept, and the timer begins its pulse at the end of
/// the pause. A request while the output is high is kept until the next one, or until the timer repeats. The newest
/// request counts.
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
  /// A period of the counter, from an update event to the next one.
  struct Period {
    /// CCR1: the output is high below this count; 0: there is no pulse. It is volatile, because finish_last_pulse() may
    /// interrupt the program anywhere.
    volatile std::uint32_t width = 0;
    std::uint32_t free_from = 0;  ///< from this count on the output has been low for the pause; at most `last` + 1
    std::uint32_t last = 0;       ///< ARR: the last count
  };

  bool follow_timer();
  void settle();
  void begin(const Period& period);
  void request(const Period& period);
  [[nodiscard]] bool continue_with_internal_oscillator() const;

  bool is_running_ = false;  ///< whether the timer runs: there was a pulse
  Period running_;           ///< with which the timer compares; if UIF is set, it has begun next_ since
  Period next_;              ///< what CCR1 and ARR hold: the timer begins it when the counter wraps
};

}  // namespace proleg::stm32f405
