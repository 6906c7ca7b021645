#include "firmware/stm32f405/supply.hpp"

#include "firmware/stm32f405/registers/rcc.hpp"

namespace proleg::stm32f405 {

void Supply::start() {
  rcc::apb1enr.set(rcc::apb1enr_pwr);
  static_cast<void>(rcc::apb1enr.read());
  pwr::cr.change(pwr::cr_pls_mask, pwr::cr_pls_2v8);
  pwr::cr.set(pwr::cr_pvde);
  exti::rtsr.set(exti::line_pvd);
  exti::ftsr.set(exti::line_pvd);
  exti::imr.set(exti::line_pvd);
  has_dropped_.store(is_low(), std::memory_order_relaxed);  // no edge comes if the voltage is low already
}

}  // namespace proleg::stm32f405
