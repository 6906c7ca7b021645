#pragma once

#include "firmware/module/ports.hpp"
#include "shared/canopen/objects.hpp"

namespace proleg::firmware {

/// Reads the sensors of servo and chip once a tick, and detects over-current and sensors that do not measure.
class ServoMonitor {
 public:
  /// Number of calls in a row without new readings that is a failure. A single one can come right after another call.
  static constexpr std::uint8_t max_stale_readings = 5;

  /// measures_current: without a sensor the current is 0, and over-current is not detected, whatever the limit.
  ServoMonitor(SensorPort& port, bool measures_current) : port_(port), measures_current_(measures_current) {}

  /// Temperature at which the chip is too hot. Its junction may have 105 degrees (data sheet DS8626, general operating
  /// conditions).
  static constexpr std::int8_t max_temperature_c = 95;
  /// Temperature below which the chip is no longer too hot.
  static constexpr std::int8_t cool_temperature_c = 85;

  /// Takes the limits from the settings of the board; nothing is read yet. Without a feedback potentiometer an angle in
  /// the readings is noise.
  void reset(const BoardRecord& board);

  /// Object 0x200A: limit of the current. The mean current begins with a reading above limit_ma, and begins again if it
  /// falls to the limit. If it stays above the limit for limit_time_ms, that is over-current; limit 0: there is no
  /// over-current.
  [[nodiscard]] std::uint16_t limit_ma() const { return limit_ma_; }
  void set_limit_ma(std::uint16_t limit_ma) { limit_ma_ = limit_ma; }
  [[nodiscard]] std::uint16_t limit_time_ms() const { return limit_time_ms_; }
  void set_limit_time_ms(std::uint16_t time_ms) { limit_time_ms_ = time_ms; }

  /// Takes a reading. The next one comes with the next tick. If that does not come, a reading is due half a tick period
  /// later, because a servo that holds the safe pose can stall, too.
  void read(Microseconds now, std::uint32_t tick_period_us);
  [[nodiscard]] Microseconds next_deadline() const { return next_reading_; }

  /// Whether the last reading was over-current.
  [[nodiscard]] bool over_current() const { return over_current_; }
  /// Whether the chip has reached max_temperature_c and has not cooled down since.
  [[nodiscard]] bool is_too_hot() const { return is_too_hot_; }
  /// Whether the sensors have stopped measuring. Over-current is not detected then.
  [[nodiscard]] bool sensors_failed() const { return stale_readings_ >= max_stale_readings; }
  /// Starts the detection of over-current again, without the readings so far.
  void clear_over_current();

  // The last readings. A current above 32,767 mA counts as 32,767 mA.
  [[nodiscard]] std::uint16_t current_ma() const { return readings_.current_ma; }
  [[nodiscard]] std::int8_t temperature_c() const { return readings_.temperature_c; }
  /// Angle of the joint; nothing if it is not measured.
  [[nodiscard]] const std::optional<std::int32_t>& angle() const { return readings_.angle; }
  /// Reading of the feedback potentiometer by the ADC, also if none is fitted.
  [[nodiscard]] const std::optional<std::uint16_t>& feedback_reading() const { return readings_.feedback_reading; }
  /// Angle of the joint if the last reading was a new one.
  [[nodiscard]] std::optional<std::int32_t> new_angle() const {
    return readings_.are_new ? readings_.angle : std::nullopt;
  }

 private:
  void judge_current(Microseconds now);

  SensorPort& port_;
  bool measures_current_;
  bool is_too_hot_ = false;
  bool measures_angle_ = false;
  std::uint16_t limit_ma_ = canopen::object::current_limit.default_value;
  std::uint16_t limit_time_ms_ = canopen::object::current_limit_time.default_value;
  ServoReadings readings_;
  bool over_current_ = false;
  Microseconds above_since_ = never;  ///< time of the first reading of the mean
  std::int64_t excess_ma_ = 0;        ///< sum of the readings since then, each minus the limit
  Microseconds next_reading_ = never;
  std::uint8_t stale_readings_ = 0;
};

}  // namespace proleg::firmware
