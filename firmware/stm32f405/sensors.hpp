#pragma once

#include "firmware/module/board_record.hpp"
#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/readings.hpp"

namespace proleg::stm32f405 {

/// Servo current, feedback potentiometer and the chip's temperature: the injected group of ADC1. take_readings() starts
/// it and does not wait the 33 us that it takes.
class Sensors final : public firmware::SensorPort {
 public:
  void start();
  [[nodiscard]] firmware::ServoReadings take_readings() override;
  /// There is no angle without a potentiometer, as before the first call.
  void calibrate(const firmware::BoardRecord& board) override { feedback_ = board; }

 private:
  firmware::BoardRecord feedback_;
  TemperatureCalibration temperature_;
  firmware::ServoReadings readings_;
};

}  // namespace proleg::stm32f405
