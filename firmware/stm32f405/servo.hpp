#pragma once

#include "firmware/module/ports.hpp"

namespace proleg::stm32f405 {

/// Pulses of the servo: TIM2 at 12 MHz, channel 1, in PWM mode 1 (RM0090, section 18.3.9): the output is high while the
/// counter is below CCR1. A pulse begins when pulse() sets the counter to 0; should the program not come back, it is
/// repeated when the counter comes round, a quarter later than the period.
///
/// To be seen from outside: pulses are given while CCER.CC1E = 1, and then CCR1 is the width that was asked for last.
class Servo final : public firmware::ServoPort {
 public:
  void start();
  /// width: 1 or more.
  void pulse(std::int32_t width, std::uint32_t period_us) override;
  void off() override;

 private:
  bool runs_ = false;
  std::uint32_t asked_width_ = 0;    ///< in CCR1
  std::uint32_t last_count_ = 0;     ///< in ARR
  std::uint32_t running_width_ = 0;  ///< what the counter is compared with: CCR1 as it was at the last update event
};

}  // namespace proleg::stm32f405
