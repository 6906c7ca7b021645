#pragma once

// What the module measures: the touch inputs, and the readings of the ADC.

#include <array>

#include "firmware/module/board_record.hpp"
#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/readings.hpp"

namespace proleg::stm32f405 {

/// Reads the four touch inputs, which start_pins() configures. A closed switch is a contact.
class Contacts final : public firmware::ContactPort {
 public:
  [[nodiscard]] std::uint8_t read_contacts() override;
};

/// Servo current, feedback potentiometer and the chip's temperature, by ADC1. No interrupt takes part:
/// - Current: TIM3 starts a conversion (the regular group) every 239 us, and DMA2 writes the result into a ring. A
///   reading is the mean of the samples since the reading before, at most of 61 ms. The periods of the servo's pulses,
///   its motor's and the ticks are not multiples of 239 us, a prime number, so that the samples do not miss a pulsed
///   current.
/// - The others: the injected group, which take_readings() starts. It does not wait for the result, which takes 28 us.
class Sensors final : public firmware::SensorPort {
 public:
  static constexpr std::uint32_t sample_period_us = 239;

  void start();
  [[nodiscard]] ServoReadings take_readings() override;
  /// Sets the readings of the potentiometer. There is no angle without a potentiometer, as before the first call.
  void calibrate(const firmware::BoardRecord& board) override { feedback_ = board; }

 private:
  static constexpr std::uint32_t ring_size = 256;
  static constexpr std::uint32_t ring_us = ring_size * sample_period_us;

  void start_sampling();
  void start_stream();
  void restart_sampling();
  [[nodiscard]] bool take_current();
  [[nodiscard]] bool take_others();

  firmware::BoardRecord feedback_;
  TemperatureCalibration temperature_;
  ServoReadings readings_;
  std::array<volatile std::uint16_t, ring_size> ring_{};  ///< DMA writes it
  std::uint32_t taken_ = 0;     ///< position of the next sample at the time of the last reading
  std::uint32_t taken_at_ = 0;  ///< MicrosecondClock::stamp() of the last reading
};

}  // namespace proleg::stm32f405
