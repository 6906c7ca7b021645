#include "sim/mcu/peripherals/rcc.hpp"

#include <algorithm>
#include <optional>
#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t cr = 0x00;
constexpr std::uint32_t pllcfgr = 0x04;
constexpr std::uint32_t cfgr = 0x08;
constexpr std::uint32_t cir = 0x0C;
constexpr std::uint32_t bdcr = 0x70;
constexpr std::uint32_t csr = 0x74;
constexpr std::uint32_t sscgr = 0x80;
constexpr std::uint32_t plli2scfgr = 0x84;
constexpr RegisterName registers[] = {{cr, "CR"},
                                      {pllcfgr, "PLLCFGR"},
                                      {cfgr, "CFGR"},
                                      {cir, "CIR"},
                                      {0x10, "AHB1RSTR"},
                                      {0x14, "AHB2RSTR"},
                                      {0x18, "AHB3RSTR"},
                                      {0x20, "APB1RSTR"},
                                      {0x24, "APB2RSTR"},
                                      {0x30, "AHB1ENR"},
                                      {0x34, "AHB2ENR"},
                                      {0x38, "AHB3ENR"},
                                      {0x40, "APB1ENR"},
                                      {0x44, "APB2ENR"},
                                      {0x50, "AHB1LPENR"},
                                      {0x54, "AHB2LPENR"},
                                      {0x58, "AHB3LPENR"},
                                      {0x60, "APB1LPENR"},
                                      {0x64, "APB2LPENR"},
                                      {bdcr, "BDCR"},
                                      {csr, "CSR"},
                                      {sscgr, "SSCGR"},
                                      {plli2scfgr, "PLLI2SCFGR"}};

constexpr std::uint32_t cr_hsion = 1U << 0U;
constexpr std::uint32_t cr_hsirdy = 1U << 1U;
constexpr std::uint32_t cr_hseon = 1U << 16U;
constexpr std::uint32_t cr_hserdy = 1U << 17U;
constexpr std::uint32_t cr_hsebyp = 1U << 18U;
constexpr std::uint32_t cr_csson = 1U << 19U;
constexpr std::uint32_t cr_pllon = 1U << 24U;
constexpr std::uint32_t cr_pllrdy = 1U << 25U;
constexpr std::uint32_t cr_plli2son = 1U << 26U;
/// HSICAL differs from chip to chip, but is not 0.
constexpr std::uint32_t cr_hsical = 0x80U << 8U;
constexpr std::uint32_t hsi_trim_reset = 0x10;

constexpr std::uint32_t pllcfgr_reset = 0x2400'3010;
constexpr std::uint32_t pllcfgr_bits = 0x0F43'7FFF;
constexpr std::uint32_t pllcfgr_reserved = 0x2000'0000;  // reads as after reset
constexpr std::uint32_t plli2scfgr_reset = 0x2000'3000;

constexpr std::uint32_t cfgr_sw = 0x3;
constexpr std::uint32_t cfgr_clocks = 0x0000'FCF3;  // PPRE2, PPRE1, HPRE, SW
constexpr std::uint32_t cfgr_others = 0xFFFF'0000;  // outputs, I2S, RTC
constexpr std::uint32_t cir_enables = 0x3F00;
constexpr std::uint32_t cir_cssf = 1U << 7U;
constexpr std::uint32_t cir_cssc = 1U << 23U;

/// Period of a clock without a source. It is not infinite, so that products of it fit.
constexpr LocalTime lost = 1'000 * local_time_per_us;
constexpr Clocks lost_clocks{.core = lost, .apb1 = lost, .apb2 = lost, .apb1_timers = lost, .apb2_timers = lost};

constexpr std::uint32_t csr_lsion = 1U << 0U;
constexpr std::uint32_t csr_lsirdy = 1U << 1U;
constexpr std::uint32_t csr_rmvf = 1U << 24U;
constexpr std::uint32_t csr_borrstf = 1U << 25U;
constexpr std::uint32_t csr_pinrstf = 1U << 26U;
constexpr std::uint32_t csr_porrstf = 1U << 27U;
constexpr std::uint32_t csr_sftrstf = 1U << 28U;
constexpr std::uint32_t csr_iwdgrstf = 1U << 29U;

}  // namespace

void Rcc::Oscillator::switch_to(bool wanted, LocalTime now, LocalTime start, LocalTime stop) {
  if (wanted == on) {
    return;
  }
  if (wanted) {
    ready_at = now + start;
  } else {
    not_ready_at = ready(now) ? now + stop : now;
  }
  on = wanted;
}

Rcc::Rcc(ChipServices& chip, FlashInterface& flash, Pwr& power, Iwdg& iwdg, std::uint32_t crystal)
    : RegisterBlock(chip, "RCC", 0x4002'3800, 0x400, registers),
      flash_(&flash),
      power_(&power),
      iwdg_(&iwdg),
      crystal_(crystal) {
  start_registers(0);
}

void Rcc::require_clock(const Peripheral& peripheral, std::uint32_t offset) const {
  if (const auto obstacle = gates_.obstacle(peripheral)) {
    throw UnmodelledAccess(peripheral.register_name(offset) +
                           (obstacle->is_reset ? ": it is held in reset (" : ": its clock is off (") +
                           register_name(obstacle->offset) + " bit " + std::to_string(obstacle->bit) + ")");
  }
}

void Rcc::note_start(ResetCause cause) {
  switch (cause) {
    case ResetCause::power_on:
      reset_flags_ = csr_porrstf | csr_pinrstf | csr_borrstf;
      break;
    case ResetCause::brown_out:
      reset_flags_ |= csr_borrstf | csr_pinrstf;
      break;
    case ResetCause::pin:
      reset_flags_ |= csr_pinrstf;
      break;
    case ResetCause::software:
      reset_flags_ |= csr_sftrstf | csr_pinrstf;
      break;
    case ResetCause::independent_watchdog:
      reset_flags_ |= csr_iwdgrstf | csr_pinrstf;
      break;
  }
}

void Rcc::reset() {
  start_registers(chip().now());
  chip().set_non_maskable(false);
}

void Rcc::start_registers(LocalTime now) {
  hsi_ = {.on = true, .ready_at = now, .not_ready_at = 0};
  hse_ = {};
  pll_ = {};
  lsi_ = {};
  hsi_trim_ = hsi_trim_reset;
  pllcfgr_ = pllcfgr_reset;
  cfgr_ = 0;
  current_ = ClockSource::hsi;
  clocks_ = {};
  stands_still_ = false;
  is_secured_ = false;
  has_reported_ = false;
  failure_seen_at_ = never_on_chip;
  gates_.reset();
}

const Rcc::Oscillator& Rcc::oscillator(ClockSource source) const {
  switch (source) {
    case ClockSource::hse:
      return hse_;
    case ClockSource::pll:
      return pll_;
    case ClockSource::hsi:
      break;
  }
  return hsi_;
}

LocalTime Rcc::next_event() const {
  const auto selected = static_cast<ClockSource>(cfgr_ & cfgr_sw);
  const LocalTime takes_over =
      selected == current_ || !oscillator(selected).on ? never_on_chip : oscillator(selected).ready_at;
  return std::min(takes_over, failure_seen_at_);
}

void Rcc::advance() { settle(); }

void Rcc::settle() {
  if (failure_seen_at_ <= chip().now()) {
    react_to_failure();
  }
  const auto selected = static_cast<ClockSource>(cfgr_ & cfgr_sw);
  if (selected != current_ && oscillator(selected).ready(chip().now())) {
    const Clocks next = clocks_of(selected, cfgr_, cfgr_);
    current_ = selected;
    change_clocks(next);
  }
}

bool Rcc::oscillates(ClockSource source) const {
  switch (source) {
    case ClockSource::hse:
      return crystal_runs_;
    case ClockSource::pll:
      return crystal_runs_ || !pll_from_hse(pllcfgr_);
    case ClockSource::hsi:
      break;
  }
  return true;
}

bool Rcc::works(ClockSource source) const { return oscillates(source) && (pll_locks_ || source != ClockSource::pll); }

Clocks Rcc::present_clocks() const {
  if (!oscillates(current_)) {
    return lost_clocks;
  }
  Clocks clocks = clocks_of(current_, cfgr_, cfgr_);
  if (!works(current_)) {
    for (LocalTime* period : {&clocks.core, &clocks.apb1, &clocks.apb2, &clocks.apb1_timers, &clocks.apb2_timers}) {
      *period = *period * 4 / 3;
    }
  }
  return clocks;
}

void Rcc::set_crystal(bool runs) {
  settle();
  if (runs == crystal_runs_) {
    return;
  }
  crystal_runs_ = runs;
  const LocalTime now = chip().now();
  if (!hse_.ready(now)) {
    hse_.ready_at = runs ? now + hse_start : never_on_chip;
  }
  oscillator_failed_or_works();
}

void Rcc::set_pll(bool locks) {
  settle();
  pll_locks_ = locks;
  oscillator_failed_or_works();
}

void Rcc::oscillator_failed_or_works() {
  const LocalTime now = chip().now();
  if (!works(ClockSource::pll)) {
    pll_.ready_at = never_on_chip;
  } else if (pll_.on && pll_.ready_at == never_on_chip) {
    pll_.ready_at = now + pll_start;
  }
  watch_crystal();
  if (const Clocks next = present_clocks(); next.core != clocks_.core) {
    set_clocks(next, !oscillates(current_));
  }
  chip().reschedule();
}

void Rcc::watch_crystal() {
  const LocalTime now = chip().now();
  if (crystal_runs_ || !is_secured_ || !hse_.on || !hse_.ready(now)) {
    failure_seen_at_ = never_on_chip;
  } else if (failure_seen_at_ == never_on_chip) {
    failure_seen_at_ = now + failure_detection;
  }
}

void Rcc::react_to_failure() {
  failure_seen_at_ = never_on_chip;
  const bool was_source = current_ == ClockSource::hse || (current_ == ClockSource::pll && pll_from_hse(pllcfgr_));
  hse_ = {};
  if (was_source) {
    pll_ = {};
    hsi_.switch_to(true, chip().now(), hsi_start, 0);
    cfgr_ &= ~cfgr_sw;
    current_ = ClockSource::hsi;
    set_clocks(clocks_of(current_, cfgr_, cfgr_), false);
  }
  has_reported_ = true;
  chip().set_non_maskable(true);
}

void Rcc::set_clocks(const Clocks& next, bool stands_still) {
  for (Peripheral* peripheral : gates_.attached()) {
    peripheral->clocks_fail(next);
  }
  clocks_ = next;
  stands_still_ = stands_still;
}

Clocks Rcc::clocks_of(ClockSource source, std::uint32_t setting, std::uint32_t value) const {
  const ClockSettings settings{.source = source, .pllcfgr = pllcfgr_, .cfgr = setting, .crystal = crystal_};
  const ClockOutcome outcome =
      proleg::sim::clocks_of(settings, {.core_mhz = power_->max_core_mhz(), .wait_states = flash_->wait_states()});
  if (outcome.fault) {
    reject_write(cfgr, value, *outcome.fault);
  }
  return outcome.clocks;
}

void Rcc::change_clocks(const Clocks& next) {
  for (Peripheral* peripheral : gates_.attached()) {
    peripheral->clocks_change(next);
  }
  clocks_ = next;
  chip().reschedule();
}

bool Rcc::lsi_ready() const { return lsi_.ready(chip().now()) || iwdg_->is_running(); }

std::uint32_t Rcc::read(std::uint32_t offset) {
  settle();
  const LocalTime now = chip().now();
  if (PeripheralGates::contains(offset)) {
    return gates_.read(offset);
  }
  switch (offset) {
    case cr:
      return (hsi_.on ? cr_hsion : 0) | (hsi_.ready(now) ? cr_hsirdy : 0) | hsi_trim_ << 3U | cr_hsical |
             (is_secured_ ? cr_csson : 0) | (hse_.on ? cr_hseon : 0) | (hse_.ready(now) ? cr_hserdy : 0) |
             (pll_.on ? cr_pllon : 0) | (pll_.ready(now) ? cr_pllrdy : 0);
    case pllcfgr:
      return pllcfgr_;
    case cfgr:
      return cfgr_ | static_cast<std::uint32_t>(current_) << 2U;
    case cir:
      return has_reported_ ? cir_cssf : 0;
    case bdcr:
    case sscgr:
      return 0;
    case csr:
      return reset_flags_ | (lsi_ready() ? csr_lsirdy : 0) | (lsi_.on ? csr_lsion : 0);
    case plli2scfgr:
      return plli2scfgr_reset;
    default:
      reject_read(offset);
  }
}

void Rcc::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  if (PeripheralGates::contains(offset)) {
    if (const auto rejection = gates_.write(offset, value)) {
      reject_write(offset, value, *rejection);
    }
    return;
  }
  switch (offset) {
    case cr:
      write_cr(value);
      break;
    case pllcfgr:
      write_pllcfgr(value);
      break;
    case cfgr:
      write_cfgr(value);
      break;
    case cir:
      reject_bits(offset, value, cir_enables, "interrupts of the RCC are not modelled");
      if ((value & cir_cssc) != 0) {
        has_reported_ = false;
        chip().set_non_maskable(false);
      }
      break;
    case bdcr:
    case sscgr:
      reject_bits(offset, value, ~0U,
                  offset == bdcr ? "the backup domain is not modelled" : "spread spectrum is not modelled");
      break;
    case csr:
      write_csr(value);
      break;
    case plli2scfgr:
      if (value != plli2scfgr_reset) {
        reject_write(offset, value, "PLLI2S is not modelled");
      }
      break;
    default:
      reject_write(offset, value);
  }
}

void Rcc::write_cr(std::uint32_t value) {
  reject_bits(cr, value, cr_hsebyp, "the board has a crystal, no clock to bypass it");
  reject_bits(cr, value, cr_plli2son, "PLLI2S is not modelled");
  if (field(value, 3, 5) != hsi_trim_) {
    reject_write(cr, value, "HSITRIM = " + std::to_string(field(value, 3, 5)) + ": trimming is not modelled");
  }
  const LocalTime now = chip().now();
  const bool from_hse = pll_from_hse(pllcfgr_);
  const bool uses_pll = current_ == ClockSource::pll;
  const bool uses_hse = current_ == ClockSource::hse || (uses_pll && from_hse);
  const bool uses_hsi = current_ == ClockSource::hsi || (uses_pll && !from_hse);
  // The source of the system clock cannot be switched off.
  const bool hsi_on = (value & cr_hsion) != 0 || uses_hsi;
  const bool hse_on = (value & cr_hseon) != 0 || uses_hse;
  const bool pll_on = (value & cr_pllon) != 0 || uses_pll;
  if (pll_on) {
    if (!pll_.on) {
      if (const std::optional<std::string> fault = pll_fault(pllcfgr_, crystal_)) {
        reject_write(cr, value, "PLLON with " + *fault);
      }
      if (!(from_hse ? hse_ : hsi_).ready(now)) {
        reject_write(cr, value, std::string("PLLON while its clock ") + (from_hse ? "HSE" : "HSI") + " is not ready");
      }
    }
    if (!(from_hse ? hse_on : hsi_on)) {
      reject_write(cr, value, std::string("PLLON without its clock ") + (from_hse ? "HSE" : "HSI"));
    }
  }
  constexpr LocalTime stop_cycles = 6;
  hsi_.switch_to(hsi_on, now, hsi_start, stop_cycles * hsi_period);
  hse_.switch_to(hse_on, now, hse_start, stop_cycles * local_time_per_us * 1'000'000 / crystal_);
  if (!crystal_runs_ && hse_.on && !hse_.ready(now)) {
    hse_.ready_at = never_on_chip;
  }
  pll_.switch_to(pll_on, now, pll_start, 0);
  if (!works(ClockSource::pll)) {
    pll_.ready_at = never_on_chip;
  }
  is_secured_ = (value & cr_csson) != 0;
  watch_crystal();
}

void Rcc::write_pllcfgr(std::uint32_t value) {
  const std::uint32_t next = (value & pllcfgr_bits) | pllcfgr_reserved;
  if (next != pllcfgr_ && pll_.on) {
    reject_write(pllcfgr, value, "the PLL is on (RM0090, 7.3.2)");
  }
  pllcfgr_ = next;
}

void Rcc::write_cfgr(std::uint32_t value) {
  reject_bits(cfgr, value, cfgr_others, "clocks for pins, I2S and RTC are not modelled");
  const std::uint32_t next = value & cfgr_clocks;
  if ((next & cfgr_sw) == cfgr_sw) {
    reject_write(cfgr, value, "SW = 3 is not allowed");
  }
  // A clock that is not ready takes over when it becomes ready.
  const auto selected = static_cast<ClockSource>(next & cfgr_sw);
  const ClockSource source = oscillator(selected).ready(chip().now()) ? selected : current_;
  const Clocks clocks = clocks_of(source, next, value);
  cfgr_ = next;
  current_ = source;
  change_clocks(clocks);
}

void Rcc::write_csr(std::uint32_t value) {
  const bool lsi_on = (value & csr_lsion) != 0;
  constexpr std::uint64_t stop_cycles = 3;
  lsi_.switch_to(lsi_on, chip().now(), lsi_start, iwdg_->lsi_cycles(stop_cycles));
  iwdg_->lsi_switched(lsi_on);
  if ((value & csr_rmvf) != 0) {
    reset_flags_ = 0;
  }
}

}  // namespace proleg::sim
