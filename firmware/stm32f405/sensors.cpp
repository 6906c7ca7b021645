#include "firmware/stm32f405/sensors.hpp"

#include "firmware/stm32f405/factory_data.hpp"
#include "firmware/stm32f405/registers/adc.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t adc_hz = board::apb2 / 4;  // at most 36 MHz (data sheet, table 67)
/// 3 us from switching on to the first conversion, 10 us from switching the temperature sensor on (tables 67, 69). A
/// read of a register takes 3 cycles of the core or more.
constexpr std::uint32_t reads_in_10_us = board::core / 100'000 / 3;

// A conversion takes 12 cycles and its sampling time, which must be 10 us for the temperature sensor (table 69).
constexpr std::uint32_t temperature_sampling_cycles = 480;
static_assert(temperature_sampling_cycles > adc_hz / 100'000);

}  // namespace

void Sensors::start() {
  temperature_ = factory::temperature_calibration();
  rcc::apb2enr.set(rcc::apb2enr_adc1);
  static_cast<void>(rcc::apb2enr.read());
  adc1::ccr.write(adc1::ccr_adcpre_4 | adc1::ccr_tsvrefe);
  adc1::cr1.write(adc1::cr1_scan);
  adc1::smpr1.write(adc1::smpr1_of(board::servo_current_channel, adc1::sampling_84_cycles) |
                    adc1::smpr1_of(board::feedback_channel, adc1::sampling_84_cycles) |
                    adc1::smpr1_of(board::temperature_channel, adc1::sampling_480_cycles));
  adc1::jsqr.write(adc1::jsqr_of(board::servo_current_channel, board::feedback_channel, board::temperature_channel));
  adc1::cr2.write(adc1::cr2_adon);
  for (std::uint32_t reads = reads_in_10_us; reads != 0; --reads) {
    static_cast<void>(adc1::cr2.read());
  }
  adc1::cr2.write(adc1::cr2_adon | adc1::cr2_jswstart);
}

firmware::ServoReadings Sensors::take_readings() {
  readings_.are_new = adc1::sr.has(adc1::sr_jeoc);
  if (!readings_.are_new) {
    return readings_;  // called again within 33 us, or the ADC has stopped
  }
  readings_.current_ma = current_of(adc1::jdr1.read() & adc1::jdr_mask);
  readings_.angle.reset();
  if (feedback_.has_feedback) {
    readings_.angle = feedback_angle_of(adc1::jdr2.read() & adc1::jdr_mask, feedback_.feedback_at_minus_90,
                                        feedback_.feedback_at_plus_90);
  }
  readings_.temperature_c = temperature_of(adc1::jdr3.read() & adc1::jdr_mask, temperature_);
  adc1::sr.write(~adc1::sr_jeoc);
  adc1::cr2.write(adc1::cr2_adon | adc1::cr2_jswstart);
  return readings_;
}

}  // namespace proleg::stm32f405
