#include "firmware/stm32f405/sensors.hpp"

#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/factory_data.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/adc.hpp"
#include "firmware/stm32f405/registers/dma.hpp"
#include "firmware/stm32f405/registers/gpio.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/registers/timer.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t adc_hz = board::apb2 / 4;  // at most 36 MHz (data sheet, table 67)
/// Number of reads in 10 us, the time from switching the temperature sensor on to its first conversion; the ADC takes 3
/// us (tables 67, 69). A read of a register takes 3 cycles of the core or more.
constexpr std::uint32_t reads_in_10_us = board::core / 100'000 / 3;

// A conversion takes 12 cycles and its sampling time, which must be 10 us for the temperature sensor (table 69).
constexpr std::uint32_t temperature_sampling_cycles = 480;
static_assert(temperature_sampling_cycles > adc_hz / 100'000);

/// Sampling of a channel in SMPR1. Those inside the chip need longer.
constexpr std::uint32_t sampling_of(unsigned channel) {
  return adc1::smpr1_of(channel,
                        channel < board::temperature_channel ? adc1::sampling_84_cycles : adc1::sampling_480_cycles);
}

/// Channel 0 of this stream is ADC1 (RM0090, table 43).
constexpr dma::Stream samples(dma::dma2, 0);

/// Value of CR2 while the current is sampled.
constexpr std::uint32_t on =
    adc1::cr2_adon | adc1::cr2_dma | adc1::cr2_dds | adc1::cr2_extsel_tim3_trgo | adc1::cr2_exten_rising;

}  // namespace

std::uint8_t Contacts::read_contacts() {
  // All four inputs are read at once, so that they are from the same instant.
  constexpr auto& pins = board::contacts;
  const std::uint32_t levels = GpioPort(pins[0].port).idr().read();
  if constexpr (pins[1].number == pins[0].number + 1 && pins[2].number == pins[0].number + 2 &&
                pins[3].number == pins[0].number + 3) {
    constexpr std::uint32_t all = 15;
    return static_cast<std::uint8_t>(~(levels >> pins[0].number) & all);
  }
  std::uint32_t contacts = 0;
  for (unsigned i = 0; i < pins.size(); ++i) {
    contacts |= (~(levels >> pins[i].number) & 1U) << i;
  }
  return static_cast<std::uint8_t>(contacts);
}

void Sensors::start() {
  temperature_ = factory::temperature_calibration();
  rcc::apb2enr.set(rcc::apb2enr_adc1);
  static_cast<void>(rcc::apb2enr.read());
  adc1::ccr.write(adc1::ccr_adcpre_4 | adc1::ccr_tsvrefe);
  adc1::cr1.write(adc1::cr1_scan);
  adc1::smpr1.write(sampling_of(board::servo_current_channel) | sampling_of(board::feedback_channel) |
                    sampling_of(board::temperature_channel));
  adc1::sqr1.write(0);
  adc1::sqr3.write(board::servo_current_channel);
  adc1::jsqr.write(adc1::jsqr_of(board::feedback_channel, board::temperature_channel));
  adc1::cr2.write(adc1::cr2_adon);
  for (std::uint32_t reads = reads_in_10_us; reads != 0; --reads) {
    static_cast<void>(adc1::cr2.read());
  }
  start_sampling();
  adc1::cr2.write(on | adc1::cr2_jswstart);
}

void Sensors::start_sampling() {
  rcc::ahb1enr.set(rcc::ahb1enr_dma2);
  rcc::apb1enr.set(rcc::apb1enr_tim3);
  static_cast<void>(rcc::apb1enr.read());
  start_stream();
  adc1::cr2.write(on);
  tim3.psc().write(board::apb1_timers / 1'000'000 - 1);
  tim3.arr().write(sample_period_us - 1);
  tim3.egr().write(Timer::egr_ug);  // loads the prescaler
  tim3.cr2().write(Timer::cr2_mms_update);
  tim3.cr1().write(Timer::cr1_cen);
}

void Sensors::start_stream() {
  samples.par.write(adc1::dr);
  samples.m0ar.write(static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(ring_.data())));
  samples.ndtr.write(ring_size);
  samples.cr.write(dma::cr_en | dma::cr_circ | dma::cr_minc | dma::cr_psize_16 | dma::cr_msize_16);
  taken_ = 0;
  taken_at_ = MicrosecondClock::stamp();
}

/// Starts sampling again after an overrun, in the manual's order: the stream before OVR is cleared (13.8.1). A stream
/// that failed ends in an overrun, too, two samples later. If the stream does not stop, the next reading tries again.
[[gnu::noinline]] void Sensors::restart_sampling() {
  constexpr std::uint32_t reads_until_stopped = 100;  // the stream ends the transfer of one sample (10.3.17)
  adc1::cr2.write(adc1::cr2_adon);
  samples.cr.write(0);
  if (!wait_until_clear(samples.cr, dma::cr_en, reads_until_stopped)) {
    return;
  }
  samples.clear_flags(dma::all_flags);
  start_stream();
  adc1::sr.write(~(adc1::sr_ovr | adc1::sr_eoc));
  adc1::cr2.write(on);
}

ServoReadings Sensors::take_readings() {
  const bool is_current_new = take_current();
  if (adc1::sr.has(adc1::sr_ovr)) {
    restart_sampling();
  }
  readings_.are_new = take_others() && is_current_new;
  return readings_;
}

/// Takes the current. False if no sample has come since the last reading, or if more than the ring holds came in the
/// time of exactly one ring.
bool Sensors::take_current() {
  const std::uint32_t next = ring_size - samples.ndtr.read();
  const std::uint32_t now = MicrosecondClock::stamp();
  std::uint32_t count = (next - taken_) % ring_size;
  if (count == 0) {
    return false;
  }
  if (now - taken_at_ > ring_us) {
    count = ring_size;  // the ring was written more than once
  }
  std::uint32_t sum = 0;
  for (std::uint32_t back = 1; back <= count; ++back) {
    sum += ring_[(next - back) % ring_size];
  }
  readings_.current_ma = board::profile.servo_current ? current_of((sum + count / 2) / count) : std::uint16_t{0};
  taken_ = next;
  taken_at_ = now;
  return true;
}

/// Takes the other readings. False if it is called again within 28 us, or the ADC has stopped.
bool Sensors::take_others() {
  if (!adc1::sr.has(adc1::sr_jeoc)) {
    return false;
  }
  const std::uint32_t feedback = adc1::jdr1.read() & adc1::jdr_mask;
  readings_.feedback_reading = static_cast<std::uint16_t>(feedback);
  readings_.angle.reset();
  if (feedback_.has_feedback) {
    readings_.angle = feedback_angle_of(feedback, feedback_.feedback_at_minus_90, feedback_.feedback_at_plus_90);
  }
  readings_.temperature_c = temperature_of(adc1::jdr2.read() & adc1::jdr_mask, temperature_);
  adc1::sr.write(~adc1::sr_jeoc);
  adc1::cr2.write(on | adc1::cr2_jswstart);
  return true;
}

}  // namespace proleg::stm32f405
