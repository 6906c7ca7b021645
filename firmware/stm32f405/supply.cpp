#include "firmware/stm32f405/supply.hpp"

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"

namespace proleg::stm32f405 {
namespace {

bool is_below() { return pwr::csr.has(pwr::csr_pvdo); }

/// Sets the threshold, and waits until the detector compares with it. The manuals give no time: this is 20 us at the
/// greatest clock.
void compare_with(std::uint32_t level) {
  constexpr std::uint32_t reads_in_20_us = board::core / 50'000 / 3;
  pwr::cr.change(pwr::cr_pls_mask, level);
  for (std::uint32_t reads = reads_in_20_us; reads != 0; --reads) {
    static_cast<void>(pwr::csr.read());
  }
}

}  // namespace

bool start_detector() {
  rcc::apb1enr.set(rcc::apb1enr_pwr);
  static_cast<void>(rcc::apb1enr.read());
  pwr::cr.set(pwr::cr_pvde);
  // As look() does it, so that a program that starts does not end at once.
  compare_with(pwr::cr_pls_2v8);
  compare_with(pwr::cr_pls_2v5);
  return !is_below();
}

bool is_flash_supplied() {
  const std::uint32_t level = pwr::cr.read() & pwr::cr_pls_mask;
  if (level == pwr::cr_pls_2v8) {
    return !is_below();
  }
  const std::uint32_t enabled = exti::imr.read();
  exti::imr.clear(exti::line_pvd);
  compare_with(pwr::cr_pls_2v8);
  const bool is_supplied = !is_below();
  compare_with(level);
  if (!is_below()) {
    exti::pr.write(exti::line_pvd);  // the edges of this comparison; an edge that lasts stays pending
  }
  exti::imr.write(enabled);
  return is_supplied;
}

void enable_detector_interrupt() {
  exti::rtsr.set(exti::line_pvd);
  exti::ftsr.set(exti::line_pvd);
  exti::imr.set(exti::line_pvd);
}

void Supply::start() {
  compare_with(pwr::cr_pls_2v8);
  enable_detector_interrupt();
  has_dropped_.store(is_below(), std::memory_order_relaxed);  // no edge comes if the voltage is low already
}

Supply::Level Supply::look(std::uint32_t stamp) {
  if (stamp - changed_at_ < look_every_us) {
    return Level::low;
  }
  if (threshold_ == pwr::cr_pls_2v5 && is_below()) {
    return Level::none;
  }
  const bool is_good = threshold_ == pwr::cr_pls_2v9 && !is_below();
  const std::uint32_t other = threshold_ == pwr::cr_pls_2v9 ? pwr::cr_pls_2v5 : pwr::cr_pls_2v9;
  threshold_ = is_good ? pwr::cr_pls_2v8 : other;
  changed_at_ = stamp;
  pwr::cr.change(pwr::cr_pls_mask, threshold_);
  return is_good ? Level::good : Level::low;
}

}  // namespace proleg::stm32f405
