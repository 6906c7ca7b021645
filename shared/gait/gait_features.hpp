#pragma once

#include <cstdint>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// What a robot senses, as numbers that change slowly and by which it can choose its gait: low-pass filtered
/// quantities, x <- x + (input - x) tick / window. They are computed on the joint that chooses, from the readings of
/// its module and the contacts of all links. docs/gait-selector.md defines them.
struct GaitFeatures {
  /// Position of a feature in a state. The number of a feature in rules is 1 more. All are ratios, Q28.
  enum Feature : std::uint8_t {
    pitch,           ///< inclination of the link behind the joint, front above rear; 1: 90 degrees
    pitch_swing,     ///< distance of the inclination from `pitch`; 1: 90 degrees
    roll,            ///< roll of this link to either side; 1: 180 degrees, upside down
    touch,           ///< part of the links that touch something
    head_touch,      ///< part of the time in which the first link touches something
    touch_changes,   ///< changes of touch of a link in a second, mean of the links
    current,         ///< current of the servo in A
    tracking_error,  ///< distance of the angle from its set-point; 1: 90 degrees
  };
  static constexpr unsigned count = 8;
  /// Time constants after which a feature follows what is sensed: 5 % of an old value are left.
  static constexpr std::int32_t windows_to_follow = 3;
  /// Number of values of a state: the features, then the first 31 links that touch, a bit each.
  static constexpr unsigned state_size = count + 1;
  /// Number of derived constants.
  static constexpr unsigned derived_size = 3;

  std::int32_t part;        ///< part of a difference that a feature moves in a tick, Q30
  std::uint32_t used;       ///< bit n for feature n; the others are 0
  std::int32_t link_share;  ///< part of all links that a link is, as a ratio

  /// window_ms: time constant, from 1. used: bit n for feature n; those from which they are computed are added.
  [[nodiscard]] static GaitFeatures make(const JointContext& context, std::int32_t window_ms, std::uint32_t used);

  /// Writes the constants into derived constants, from which load() reads them in the tick.
  void store(std::int32_t* derived) const;
  [[nodiscard]] static GaitFeatures load(const std::int32_t* derived) {
    return {derived[0], static_cast<std::uint32_t>(derived[1]), derived[2]};
  }

  /// The readings without which these features have no input: bits of JointReadings::Sensor.
  [[nodiscard]] static std::uint8_t required_readings(std::uint32_t used);

  /// Computes one tick. state and next: state_size values each. A feature whose sensor gives nothing keeps its value.
  void advance(const Surroundings& surroundings, const std::int32_t* state, std::int32_t* next) const;

 private:
  [[nodiscard]] bool uses(Feature feature) const { return ((used >> unsigned{feature}) & 1U) != 0; }
  void advance_touch(const Surroundings& surroundings, const std::int32_t* state, std::int32_t* next) const;
  void advance_readings(const Surroundings& surroundings, const std::int32_t* state, std::int32_t* next) const;
};

}  // namespace proleg
