#include "firmware/stm32f405/watchdog.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t lsi_hz = 32'000;
constexpr std::uint32_t prescaler = 16;
constexpr std::uint32_t counts_of_a_millisecond = lsi_hz / prescaler / 1'000;

/// The watchdog loads PR and RLR within 5 periods of LSI; the core still runs at 16 MHz, 5 cycles or more a read.
constexpr std::uint32_t reads_in_5_ms = 16'000;

}  // namespace

bool start_watchdog(std::uint32_t milliseconds) {
  iwdg::kr.write(iwdg::kr_start);  // first: it switches on LSI, which the others need
  iwdg::kr.write(iwdg::kr_unlock);
  iwdg::pr.write(iwdg::pr_16);
  iwdg::rlr.write(milliseconds * counts_of_a_millisecond - 1U);
  const bool done = wait_until_clear(iwdg::sr, iwdg::sr_updating, reads_in_5_ms);
  feed_watchdog();
  return done;
}

}  // namespace proleg::stm32f405
