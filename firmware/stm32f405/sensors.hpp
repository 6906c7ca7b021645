#pragma once

#include "firmware/module/board_record.hpp"
#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/readings.hpp"

namespace proleg::stm32f405 {

/// Servo current, feedback potentiometer and the chip's temperature: the injected group of ADC1. take_readings() starts
/// it and does not wait the 33 us that it takes.
class Sensors final : public firmware::SensorPort {
 public:
  /// There is no angle without a record that has a potentiometer.
  void start(const std::optional<firmware::BoardRecord>& record);
  [[nodiscard]] firmware::ServoReadings take_readings() override;

 private:
  std::optional<firmware::BoardRecord> feedback_;  ///< of a board with a potentiometer
  TemperatureCalibration temperature_;
  firmware::ServoReadings readings_;
};

}  // namespace proleg::stm32f405
