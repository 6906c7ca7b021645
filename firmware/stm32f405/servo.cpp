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

/// More than the program needs from a look at the counter to the last write that depends on it: 5 us are 840 cycles.
constexpr std::uint32_t handling_counts = 5 * counts_per_us;

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
constexpr std::uint32_t counts_late = 6 * counts_per_us + 1;

/// While it exists, no interrupt comes.
class InterruptsOff {
 public:
  InterruptsOff() { asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(primask_) : : "memory"); }
  ~InterruptsOff() { asm volatile("msr primask, %0" : : "r"(primask_) : "memory"); }
  InterruptsOff(const InterruptsOff&) = delete;
  InterruptsOff& operator=(const InterruptsOff&) = delete;

 private:
  std::uint32_t primask_ = 0;
};

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

/// Whether the counter has wrapped: then the timer has begun the period that was next.
bool Servo::follow_timer() {
  if ((tim2.sr().read() & Timer::sr_uif) == 0) {
    return false;
  }
  running_ = next_;
  tim2.sr().write(~Timer::sr_uif);
  return true;
}

/// Waits for a wrap of the counter that is nearer than handling_counts: what is written after this takes effect
/// together, and running_ holds.
void Servo::settle() {
  // The number of reads bounds the wait for a counter that stands still.
  for (std::uint32_t reads = 0; reads < board::core / counter_hz * handling_counts; ++reads) {
    const std::uint32_t count = tim2.cnt().read();
    // If the flag is not set after the read, the counter has not wrapped since running_ was set.
    if (!follow_timer() && count + handling_counts <= running_.last) {
      return;
    }
  }
}

/// Puts a period into the registers from which the timer takes it when the counter wraps.
void Servo::request(const Period& period) {
  next_ = period;
  tim2.arr().write(period.last);
  tim2.ccr1().write(period.width);
}

/// Begins a period at once. The output must be low, and as long as the pause if the period has a pulse.
void Servo::begin(const Period& period) {
  request(period);
  running_ = period;  // before the event: finish_last_pulse() may run in between
  tim2.egr().write(Timer::egr_ug);
}

void Servo::pulse(std::int32_t width, std::uint32_t period_us) {
  const auto counts = static_cast<std::uint32_t>(width);
  const Period wanted{counts, counts + min_pause, counts_to_repeat(counts, period_us) - 1U};
  // The first pulse is whole only if no interrupt comes between the start of the counter and the pin.
  const InterruptsOff interrupts_off;
  if (!is_running_) {
    is_running_ = true;
    tim2.ccer().write(Timer::ccer_cc1e);
    begin(wanted);
    tim2.cr1().write(Timer::cr1_arpe | Timer::cr1_urs | Timer::cr1_cen);
    set_mode(board::servo, PinMode::alternate);
    return;
  }
  settle();
  request(wanted);
  // Read after the request: a pulse that ends in between has a request in its pause.
  const std::uint32_t count = tim2.cnt().read();
  if (count >= running_.free_from) {
    begin(wanted);
    return;
  }
  if (count >= running_.width) {
    // The rest of the pause becomes a period without a pulse. It is long enough for request().
    const std::uint32_t rest = std::max(running_.free_from - count, 2 * handling_counts);
    begin({0, rest, rest - 1U});
    request(wanted);
  }
}

/// Ends the pulse after the crystal has stopped: HSI clocks the core, and all prescalers are as before (RM0090, section
/// 7.2.7). The rest of the pulse becomes a pulse of its own, which begins with an update event; the output stays high
/// at this event. The timer ends it, so its length does not depend on the duration of instructions, and OC1PE stays
/// set, as PWM mode needs it. False: the pin must be low now.
bool Servo::continue_with_internal_oscillator() const {
  const std::uint32_t width = (tim2.sr().read() & Timer::sr_uif) != 0 ? next_.width : running_.width;
  const std::uint32_t left = width - tim2.cnt().read();
  if (left > max_width || left <= counts_late) {
    return false;
  }
  const std::uint32_t rest = left * internal_counts_per_us / counts_per_us;
  tim2.psc().write(0);
  tim2.ccr1().write(rest - internal_counts_late);
  tim2.egr().write(Timer::egr_ug);
  tim2.ccr1().write(0);
  return true;
}

void Servo::switch_supply(bool is_on) { switch_servo_supply(is_on); }

void Servo::finish_last_pulse() const {
  // The output register holds 0 since start_pins(). Before that the port has no clock, and the pin is an input.
  if (!rcc::ahb1enr.has(rcc::ahb1enr_gpioa)) {
    return;
  }
  if (rcc::apb1enr.has(rcc::apb1enr_tim2)) {
    tim2.ccr1().write(0);  // no further pulse begins
    if (is_high()) {
      const bool has_internal_clock = rcc::cir.has(rcc::cir_cssf);
      if (!has_internal_clock || continue_with_internal_oscillator()) {
        wait_while_high(has_internal_clock ? board::internal_oscillator : board::core);
      }
    }
  }
  set_mode(board::servo, PinMode::output);
  switch_servo_supply(false);
}

void Servo::off() {
  if (!is_running_) {
    return;
  }
  const InterruptsOff interrupts_off;
  settle();
  // At the next wrap the output has been low for the pause.
  request({0, 0, next_.last});
  const std::uint32_t count = tim2.cnt().read();
  if (count >= running_.width) {
    begin({0, running_.free_from - std::min(running_.free_from, count), next_.last});
    next_.free_from = 0;
  }
}

}  // namespace proleg::stm32f405
