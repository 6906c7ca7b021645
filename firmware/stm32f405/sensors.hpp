#pragma once

// What the module measures: the touch inputs, the readings of the ADC, and whether the chip's supply is too low.

#include <array>
#include <atomic>

#include "firmware/module/board_record.hpp"
#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/readings.hpp"
#include "firmware/stm32f405/registers/supply.hpp"

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

/// The voltage detector (RM0090, section 5.2.3), which watches the chip's supply of 3.3 V. Its threshold falls to 2.93
/// V and rises to 3.03 V (data sheet, embedded reset and power control block: typical; 2.84 V at least). Below 2.7 V
/// the flash needs more wait states than it has at 168 MHz (RM0090, table 10).
class Supply {
 public:
  void start();

  /// Whether the voltage was too low since the last call, for any length of time.
  [[nodiscard]] bool take_drop() {
    const bool has_dropped = has_dropped_.load(std::memory_order_relaxed);
    if (has_dropped) {
      has_dropped_.store(false, std::memory_order_relaxed);
    }
    return has_dropped;
  }
  [[nodiscard]] static bool is_low() { return pwr::csr.has(pwr::csr_pvdo); }

  /// Must be called by the interrupt. It comes at both edges; the rising one is needed, because the interrupt may come
  /// late for the falling one.
  void on_interrupt() {
    exti::pr.write(exti::line_pvd);
    has_dropped_.store(true, std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> has_dropped_{false};
};

}  // namespace proleg::stm32f405
