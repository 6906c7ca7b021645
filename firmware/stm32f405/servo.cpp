#include "firmware/stm32f405/servo.hpp"

#include <algorithm>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/gpio.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t counts_per_us = servo_counts_per_us;
constexpr std::uint32_t counter_hz = counts_per_us * 1'000'000;
static_assert(board::apb1_timers % counter_hz == 0);

/// Shortest time between pulses for which the output is low.
constexpr std::uint32_t min_pause = 500 * counts_per_us;

/// Number of counts until the timer repeats a pulse because the program is late.
constexpr std::uint32_t counts_to_repeat(std::uint32_t width, std::uint32_t period_us) {
  const std::uint32_t late = period_us * counts_per_us / 4U * 5U;
  return std::max(late, width + min_pause);
}

/// Greatest width of the pulses that a servo accepts: 0.5 to 2.5 ms.
constexpr std::uint32_t max_width_us = 2'500;
constexpr std::uint32_t max_width = max_width_us * counts_per_us;

/// Counts per microsecond of the timer without prescaler after the crystal has stopped.
constexpr std::uint32_t internal_counts_per_us =
    std::uint64_t{board::apb1_timers} * board::internal_oscillator / board::core / 1'000'000;
static_assert(internal_counts_per_us == 8);

/// Counts from the switch to HSI to the update event in which the rest of the pulse begins; the counter hardly moves
/// meanwhile. These are 40 instructions at 16 MHz: with the wait states of the flash, and APB1 at 4 MHz, about 100
/// cycles.
constexpr std::uint32_t internal_counts_late = 6 * internal_counts_per_us;

bool is_high() { return (GpioPort(board::servo.port).idr().read() >> board::servo.number & 1U) != 0; }

/// Waits while the output is high, at most until the longest pulse is over. If the counter stands still, the number of
/// reads ends the wait: a read takes 5 cycles or more.
void wait_while_high(std::uint32_t core_hz) {
  for (std::uint32_t reads = core_hz / 1'000'000 * max_width_us / 5; reads != 0; --reads) {
    if (!is_high() || tim2.cnt().read() >= max_width) {
      return;
    }
  }
}

}  // namespace

void Servo::start() {
  rcc::apb1enr.set(rcc::apb1enr_tim2);
  static_cast<void>(rcc::apb1enr.read());
  set_mode(board::servo, PinMode::output);
  connect_function(board::servo, board::servo_function);
  tim2.psc().write(board::apb1_timers / counter_hz - 1);
  tim2.ccmr1().write(Timer::ccmr1_oc1m_pwm1 | Timer::ccmr1_oc1pe);
}

/// Updates active_width_: after the counter has wrapped, the requested width is active.
void Servo::follow_timer() {
  if ((tim2.sr().read() & Timer::sr_uif) != 0) {
    active_width_ = requested_width_;
    tim2.sr().write(~Timer::sr_uif);
  }
}

void Servo::pulse(std::int32_t width, std::uint32_t period_us) {
  follow_timer();
  requested_width_ = static_cast<std::uint32_t>(width);
  tim2.ccr1().write(requested_width_);
  if (const std::uint32_t last = counts_to_repeat(requested_width_, period_us) - 1U; last != last_count_) {
    last_count_ = last;
    tim2.arr().write(last);
  }
  if (!is_running_) {
    is_running_ = true;
    active_width_ = requested_width_;
    tim2.ccer().write(Timer::ccer_cc1e);
    tim2.egr().write(Timer::egr_ug);
    tim2.cr1().write(Timer::cr1_arpe | Timer::cr1_urs | Timer::cr1_cen);
    set_mode(board::servo, PinMode::alternate);
  } else if (tim2.cnt().read() >= active_width_) {
    active_width_ = requested_width_;
    tim2.egr().write(Timer::egr_ug);
  }
}

/// Ends the pulse after the crystal has stopped: HSI clocks the core, and all prescalers are as before (RM0090, section
/// 7.2.7). The rest of the pulse becomes a pulse of its own, which begins with an update event; the output stays high
/// at this event. The timer ends it, so its length does not depend on the duration of instructions, and OC1PE stays
/// set, as PWM mode needs it. False: the pin must be low now.
bool Servo::continue_with_internal_oscillator() const {
  // If the timer alone has begun this pulse, this is the width of the request before: it is one step of the servo away.
  const std::uint32_t width = active_width_;
  const std::uint32_t count = tim2.cnt().read();
  if (width > max_width || count >= width) {
    return false;
  }
  const std::uint32_t rest = (width - count) * internal_counts_per_us / counts_per_us;
  if (rest <= internal_counts_late) {
    return false;
  }
  tim2.psc().write(0);
  tim2.ccr1().write(rest - internal_counts_late);
  tim2.egr().write(Timer::egr_ug);
  return true;
}

void Servo::switch_supply(bool is_on) { switch_servo_supply(is_on); }

void Servo::finish_last_pulse() const {
  // The output register holds 0 since start_pins(). Before that the port has no clock, and the pin is an input.
  if (!rcc::ahb1enr.has(rcc::ahb1enr_gpioa)) {
    return;
  }
  if (rcc::apb1enr.has(rcc::apb1enr_tim2) && is_high()) {
    const bool has_internal_clock = rcc::cir.has(rcc::cir_cssf);
    if (!has_internal_clock || continue_with_internal_oscillator()) {
      tim2.ccr1().write(0);  // there are no further pulses
      wait_while_high(has_internal_clock ? board::internal_oscillator : board::core);
    }
  }
  set_mode(board::servo, PinMode::output);
  switch_servo_supply(false);
}

void Servo::off() {
  if (!is_running_) {
    return;
  }
  follow_timer();
  requested_width_ = 0;
  tim2.ccr1().write(0);
  if (tim2.cnt().read() >= active_width_) {
    active_width_ = 0;
    tim2.egr().write(Timer::egr_ug);
  }
}

}  // namespace proleg::stm32f405
