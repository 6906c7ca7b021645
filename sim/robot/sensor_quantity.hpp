#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {

/// One of the few numbers that stand for a sensor in summaries and plots: a laser has a thousand distances.
struct SensorQuantity {
  std::string_view name;
  std::string_view unit;  ///< "" for numbers without
};

[[nodiscard]] inline std::span<const SensorQuantity> quantities_of(SensorKind kind) {
  static constexpr std::array pressed{SensorQuantity{"pressed", ""}};
  static constexpr std::array nearest{SensorQuantity{"nearest", "m"}};
  static constexpr std::array current{SensorQuantity{"current", "mA"}};
  static constexpr std::array angles{SensorQuantity{"pitch", "deg"}, SensorQuantity{"roll", "deg"}};
  static constexpr std::array acceleration{SensorQuantity{"acceleration", "m/s^2"}};
  switch (kind) {
    case SensorKind::touch:
      return pressed;
    case SensorKind::laser:
      return nearest;
    case SensorKind::servo_current:
      return current;
    case SensorKind::inclinometer:
      return angles;
    case SensorKind::accelerometer:
      break;
  }
  return acceleration;
}

/// A quantity from the values of the sensor's channels: the smallest distance of a laser, the length of an
/// accelerometer's vector, otherwise the channel itself.
[[nodiscard]] inline double quantity_of(SensorKind kind, std::size_t quantity, std::span<const double> channels) {
  switch (kind) {
    case SensorKind::laser:
      return *std::ranges::min_element(channels);
    case SensorKind::accelerometer:
      return std::hypot(channels[0], channels[1], channels[2]);
    default:
      return channels[quantity];
  }
}

/// The kind of that name (name_of), or nothing.
[[nodiscard]] inline std::optional<SensorKind> find_sensor_kind(std::string_view name) {
  for (const SensorKind kind : {SensorKind::touch, SensorKind::laser, SensorKind::servo_current,
                                SensorKind::inclinometer, SensorKind::accelerometer}) {
    if (name_of(kind) == name) {
      return kind;
    }
  }
  return std::nullopt;
}

}  // namespace proleg::sim
