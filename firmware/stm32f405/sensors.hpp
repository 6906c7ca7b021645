#pragma once

#include "firmware/module/board_record.hpp"
#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/readings.hpp"

namespace proleg::stm32f405 {

/// Servo current, feedback potentiometer and the chip's temperature: the injected group of ADC1, started by read(). It
/// takes 33 us; nobody waits for it.
class Sensors final : public firmware::SensorPort {
 public:
  /// Without a record, or a potentiometer in it, there is no angle.
  void start(const std::optional<firmware::BoardRecord>& record);
  [[nodiscard]] firmware::ServoReadings take_readings() override;

 private:
  std::optional<firmware::BoardRecord> feedback_;  ///< of a board with a potentiometer
  TemperatureCalibration temperature_;
  firmware::ServoReadings readings_;
};

}  // namespace proleg::stm32f405
