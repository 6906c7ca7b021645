#include "sim/mcu/cpu/system_tick.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t enable = 1U;
constexpr std::uint32_t tick_interrupt = 2U;
constexpr std::uint32_t core_clock = 4U;
constexpr std::uint32_t count_flag = 1U << 16U;
constexpr std::uint32_t counter_mask = 0x00FF'FFFF;
/// CLKSOURCE clear: HCLK / 8 (RM0090, 6.2).
constexpr LocalTime external_divider = 8;

}  // namespace

void SystemTick::reset() { *this = SystemTick(); }

LocalTime SystemTick::value_at(LocalTime now) const {
  if (!is_enabled()) {
    return stopped_value_;
  }
  if (next_zero_ == never_on_chip || now >= next_zero_ || now < loads_at_) {
    return 0;
  }
  return (next_zero_ - now + period_ - 1) / period_;
}

void SystemTick::advance(LocalTime now) {
  if (!is_enabled() || now < next_zero_) {
    return;
  }
  if (reload_ == 0) {
    // It stays at 0 from now on: loading 0 stops the counter.
    if (next_zero_ != never_on_chip) {
      next_zero_ = never_on_chip;
      count_flag_ = true;
      exception_ = exception_ || (control_ & tick_interrupt) != 0;
    }
    return;
  }
  const LocalTime round = period_ * (LocalTime{reload_} + 1);
  next_zero_ += round * ((now - next_zero_) / round + 1);
  loads_at_ = next_zero_ - round + period_;
  count_flag_ = true;
  exception_ = exception_ || (control_ & tick_interrupt) != 0;
}

std::uint32_t SystemTick::read_control(LocalTime now) {
  advance(now);
  const std::uint32_t value = control_ | (count_flag_ ? count_flag : 0U);
  count_flag_ = false;
  return value;
}

void SystemTick::write_control(std::uint32_t value, LocalTime now, LocalTime core) {
  advance(now);
  const bool was_enabled = is_enabled();
  const LocalTime left = value_at(now);
  control_ = value & (enable | tick_interrupt | core_clock);
  core_ = core;
  period_ = (control_ & core_clock) != 0 ? core_ : core_ * external_divider;
  if (!is_enabled()) {
    if (was_enabled) {
      stopped_value_ = left;
    }
    next_zero_ = 0;
    return;
  }
  if (left == 0 && reload_ == 0) {
    next_zero_ = never_on_chip;
    return;
  }
  const LocalTime clocks = left == 0 ? LocalTime{reload_} + 1 : left;
  next_zero_ = now + clocks * period_;
  loads_at_ = left == 0 ? now + period_ : now;
}

void SystemTick::write_reload(std::uint32_t value, LocalTime now) {
  advance(now);
  const bool starts = is_enabled() && next_zero_ == never_on_chip;
  reload_ = value & counter_mask;
  if (starts && reload_ != 0) {
    next_zero_ = now + (LocalTime{reload_} + 1) * period_;
    loads_at_ = now + period_;
  }
}

std::uint32_t SystemTick::read_value(LocalTime now) {
  advance(now);
  return static_cast<std::uint32_t>(value_at(now)) & counter_mask;
}

void SystemTick::write_value(LocalTime now) {
  advance(now);
  count_flag_ = false;
  stopped_value_ = 0;
  if (is_enabled()) {
    next_zero_ = reload_ == 0 ? never_on_chip : now + (LocalTime{reload_} + 1) * period_;
    loads_at_ = now + period_;
  }
}

LocalTime SystemTick::next_exception() const {
  return is_enabled() && (control_ & tick_interrupt) != 0 ? next_zero_ : never_on_chip;
}

void SystemTick::set_core_period(LocalTime now, LocalTime core) {
  if (is_enabled()) {
    write_control(control_, now, core);
  }
}

bool SystemTick::take_exception() {
  const bool taken = exception_;
  exception_ = false;
  return taken;
}

}  // namespace proleg::sim
