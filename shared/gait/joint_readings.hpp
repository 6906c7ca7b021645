#pragma once

// What the sensors of a joint's module measure: readings, and touch sensors that bounce.

#include <array>
#include <cstdint>
#include <optional>

#include "shared/gait/state_frame.hpp"

namespace proleg {

/// What the sensors of a joint's module measure: its servo, and how the link behind the joint stands and moves. No
/// module has all of the sensors. The readings are those at the SYNC before, as the contacts are.
struct JointReadings {
  /// The bits of `present`.
  enum Sensor : std::uint8_t {
    servo_current = 1U << 0U,
    inclination = 1U << 1U,
    acceleration = 1U << 2U,
    angle_of_joint = 1U << 3U,
  };
  static constexpr std::uint8_t all_sensors = 0x0F;

  std::uint8_t present = 0;  ///< sensors whose readings are known; the values of others are 0
  /// Current of the servo [mA], 0 to 32,767.
  std::int32_t current_ma = 0;
  /// Binary angles of the link behind the joint, 90 degrees = 2^30. pitch: its y axis (forwards) over the horizontal,
  /// within +-90 degrees; roll: about that axis, positive with the right side down; it wraps at 180 degrees.
  std::int32_t pitch = 0;
  std::int32_t roll = 0;
  /// Acceleration of the link's centre of mass, minus gravity [mm/s^2], in the axes of the link (x to the right, y
  /// forwards, z up): at rest (0, 0, 9810). It is the mean over the tick before.
  std::array<std::int32_t, 3> acceleration_mm_s2{};
  /// Actual angle of the joint, 90 degrees = 2^30.
  std::int32_t angle = 0;

  [[nodiscard]] bool has(Sensor sensor) const { return (present & sensor) != 0; }
  /// These readings with only the sensors of these bits.
  [[nodiscard]] JointReadings only(std::uint8_t sensors) const {
    JointReadings kept;
    kept.present = static_cast<std::uint8_t>(present & sensors);
    if (kept.has(servo_current)) {
      kept.current_ma = current_ma;
    }
    if (kept.has(inclination)) {
      kept.pitch = pitch;
      kept.roll = roll;
    }
    if (kept.has(acceleration)) {
      kept.acceleration_mm_s2 = acceleration_mm_s2;
    }
    if (kept.has(angle_of_joint)) {
      kept.angle = angle;
    }
    return kept;
  }

  friend bool operator==(const JointReadings&, const JointReadings&) = default;
};

/// What the module of a joint reads from its servo and its own chip.
struct ServoReadings {
  std::uint16_t current_ma = 0;  ///< of the servo: the mean since the readings before
  /// Actual angle of the joint (binary angle); nothing without a feedback potentiometer.
  std::optional<std::int32_t> angle;
  std::int8_t temperature_c = 0;  ///< of the chip
  bool are_new = true;            ///< measured since the readings before; else they are those of an earlier time
  /// Reading of the feedback potentiometer by the ADC, 0 to 4095; noise if none is fitted.
  std::optional<std::uint16_t> feedback_reading{};
};

/// Debounces the touch sensors of a joint module: a sensor that bounces as it closes or opens counts once.
///
/// Each sensor is sampled once a tick, at SYNC. A change is accepted at the second equal sample in a row, for pressed
/// and released alike. So a steady change counts one tick late, and a change of a single tick does not count. At the
/// start nothing is pressed. The thesis debounces its sensors, too (section 5.1), but does not describe how.
class ContactDebouncer {
 public:
  /// raw: the present state of the sensors, in the bits of the state frame's byte 6 (StateFrame::contact_bits); other
  /// bits are ignored. Returns the accepted contacts in the same bits, the others 0.
  std::uint8_t sample(std::uint8_t raw) {
    const unsigned changed = raw ^ last_;
    accepted_ = static_cast<std::uint8_t>(((accepted_ & changed) | (raw & ~changed)) & StateFrame::contact_bits);
    last_ = raw;
    return accepted_;
  }

  /// Returns to the start, at which nothing is pressed.
  void reset() { *this = {}; }

 private:
  std::uint8_t last_ = 0;
  std::uint8_t accepted_ = 0;
};

}  // namespace proleg
