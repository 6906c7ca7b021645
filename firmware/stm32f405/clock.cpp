#include "firmware/stm32f405/clock.hpp"

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/flash.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"
#include "firmware/stm32f405/supply.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr PllFactors pll = pll_factors_of(board::profile.crystal);
static_assert(std::uint64_t{board::profile.crystal} * pll.n == std::uint64_t{board::core} * pll.m * pll.p);

/// Wait states of the flash: one for each 22 MHz, which is enough down to 2.1 V (RM0090, table 10). So nothing must
/// happen within microseconds when the supply falls. At 2.7 V five would do; two more cost two cycles for each line of
/// 16 bytes that neither the prefetch nor the cache has.
constexpr std::uint32_t wait_states = (board::core - 1) / 22'000'000;
static_assert(wait_states == 7);

/// Numbers of reads in two times; a read in a loop takes 5 cycles or more. The crystal starts in 2 ms (data sheet,
/// table 33) and gets 50; the PLL locks in 0.3 ms and gets 5.
constexpr std::uint32_t reads_in_50_ms = board::internal_oscillator / 20 / 5;

bool has_wait_states() { return wait_until_set(flash_interface::acr, wait_states, reads_in_50_ms); }

bool switch_to_pll() {
  rcc::cfgr.change(rcc::cfgr_sw_mask, rcc::cfgr_sw_pll);
  for (std::uint32_t reads = reads_in_50_ms / 10; reads != 0; --reads) {
    if ((rcc::cfgr.read() & rcc::cfgr_sws_mask) == rcc::cfgr_sws_pll) {
      return true;
    }
  }
  return false;
}

}  // namespace

ClockResult start_clocks() {
  if (!start_detector()) {
    return ClockResult::no_supply;
  }
  rcc::cr.set(rcc::cr_hseon);
  if (!wait_until_set(rcc::cr, rcc::cr_hserdy, reads_in_50_ms)) {
    return ClockResult::no_crystal;
  }
  rcc::cr.set(rcc::cr_csson);  // from now on, NMI comes if the crystal stops (faults.cpp)
  // 168 MHz needs the voltage regulator in scale 1, which it has from reset on (RM0090, section 5.4.1).
  rcc::pllcfgr.change(rcc::pllcfgr_mask, rcc::pllcfgr_of(pll.m, pll.n, pll.p, pll.q) | rcc::pllcfgr_pllsrc_hse);
  rcc::cr.set(rcc::cr_pllon);
  if (!wait_until_set(rcc::cr, rcc::cr_pllrdy, reads_in_50_ms / 10)) {
    return ClockResult::no_pll;
  }
  // Wait states and prescalers are set before the clock that needs them (RM0090, section 3.5.1).
  flash_interface::acr.change(flash_interface::acr_latency_mask, wait_states | flash_interface::acr_prften |
                                                                     flash_interface::acr_icen |
                                                                     flash_interface::acr_dcen);
  rcc::cfgr.change(rcc::cfgr_prescalers_mask, rcc::cfgr_hpre_1 | rcc::cfgr_ppre1_4 | rcc::cfgr_ppre2_2);
  // The flash may take new wait states some cycles later: they are read back (section 3.5.1).
  if (!has_wait_states() || !switch_to_pll()) {
    // The source is switched back first: a PLL that locks late would clock the buses without prescalers. The prescalers
    // are set back because the console needs the initial frequency of APB1.
    rcc::cfgr.change(rcc::cfgr_sw_mask, rcc::cfgr_sw_hsi);
    rcc::cfgr.change(rcc::cfgr_prescalers_mask, 0);
    return ClockResult::no_pll;
  }
  return ClockResult::ok;
}

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
