#include "firmware/stm32f405/reset.hpp"

#include "firmware/stm32f405/registers/core.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t lsi_hz = 32'000;
constexpr std::uint32_t prescaler = 16;
constexpr std::uint32_t counts_of_a_millisecond = lsi_hz / prescaler / 1'000;

/// Number of reads in 5 periods of LSI, within which the watchdog loads PR and RLR. The core still runs at 16 MHz, and
/// a read takes 5 cycles or more.
constexpr std::uint32_t reads_in_5_ms = 16'000;

}  // namespace

void reset_chip() {
  asm volatile("dsb" : : : "memory");
  scb::aircr.write(scb::aircr_sysresetreq);
  for (;;) {
    asm volatile("wfi");  // the reset takes a few cycles
  }
}

bool start_watchdog(std::uint32_t milliseconds) {
  iwdg::kr.write(iwdg::kr_start);  // comes first: it switches on LSI, which the other registers need
  iwdg::kr.write(iwdg::kr_unlock);
  iwdg::pr.write(iwdg::pr_16);
  iwdg::rlr.write(milliseconds * counts_of_a_millisecond - 1U);
  const bool done = wait_until_clear(iwdg::sr, iwdg::sr_updating, reads_in_5_ms);
  feed_watchdog();
  return done;
}

}  // namespace proleg::stm32f405
