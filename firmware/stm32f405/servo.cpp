#include "firmware/stm32f405/servo.hpp"

#include <algorithm>

#include "firmware/stm32f405/gpio.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"
#include "shared/kernel/servo_command.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t counts_per_us = servo_counts_per_us;
constexpr std::uint32_t counter_hz = counts_per_us * 1'000'000;
static_assert(board::apb1_timers % counter_hz == 0);

/// The output is low for this long at least, between pulses.
constexpr std::uint32_t min_pause = 500 * counts_per_us;

/// Counts until the timer repeats a pulse because the program is late.
constexpr std::uint32_t counts_to_repeat(std::uint32_t width, std::uint32_t period_us) {
  const std::uint32_t late = period_us * counts_per_us / 4U * 5U;
  return std::max(late, width + min_pause);
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

/// After the counter has wrapped the requested width is active.
void Servo::follow_timer() {
  if ((tim2.sr().read() & Timer::sr_uif) != 0) {
    tim2.sr().write(~Timer::sr_uif);
    active_width_ = requested_width_;
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
    tim2.ccer().write(Timer::ccer_cc1e);
    tim2.egr().write(Timer::egr_ug);
    tim2.cr1().write(Timer::cr1_arpe | Timer::cr1_urs | Timer::cr1_cen);
    set_mode(board::servo, PinMode::alternate);
    active_width_ = requested_width_;
  } else if (tim2.cnt().read() >= active_width_) {
    tim2.egr().write(Timer::egr_ug);
    active_width_ = requested_width_;
  }
}

void Servo::cut_pulse() {
  // The output register holds 0 since start_pins(). Before that the port has no clock, and the pin is an input.
  if (rcc::ahb1enr.has(rcc::ahb1enr_gpioa)) {
    set_mode(board::servo, PinMode::output);
  }
}

void Servo::off() {
  if (!is_running_) {
    return;
  }
  follow_timer();
  requested_width_ = 0;
  tim2.ccr1().write(0);
  if (tim2.cnt().read() >= active_width_) {
    tim2.egr().write(Timer::egr_ug);
    active_width_ = 0;
  }
}

}  // namespace proleg::stm32f405
