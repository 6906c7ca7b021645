#include "firmware/stm32f405/microsecond_clock.hpp"

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"

namespace proleg::stm32f405 {

void MicrosecondClock::start() {
  rcc::apb1enr.set(rcc::apb1enr_tim5);
  static_cast<void>(rcc::apb1enr.read());
  tim5.psc().write(board::apb1_timers / 1'000'000 - 1);
  tim5.egr().write(Timer::egr_ug);  // loads the prescaler
  tim5.sr().write(0);
  tim5.dier().write(Timer::dier_cc1ie);
  tim5.cr1().write(Timer::cr1_cen);
}

}  // namespace proleg::stm32f405
