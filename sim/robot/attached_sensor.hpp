#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/pose.hpp"

namespace proleg::sim {

enum class SensorKind : std::uint8_t {
  touch,          ///< whether the environment touches a region of a link, and the direction of the contact
  laser,          ///< distances in a plane
  servo_current,  ///< of a joint's servo
  inclinometer,   ///< how a link stands against the vertical
  accelerometer,  ///< acceleration of a point of a link, less gravity
};

/// One of the two inputs for touch sensors that a module has for a link.
enum class TouchInput : std::uint8_t { rear, front };

/// Rays of a laser scanner lie in the x-y plane of its frame. The angle 0 is its x axis; angles grow towards its y
/// axis.
struct LaserScan {
  double first_angle = 0.0;     ///< rad
  double angle_step = 0.0;      ///< rad, from ray to ray; above 0 if there are several
  std::size_t rays = 1;         ///< 1 to max_laser_rays
  double range = 0.0;           ///< m; also the reading of a ray that meets nothing. Above 0
  std::uint32_t period_us = 0;  ///< from scan to scan; 0: every tick
};

inline constexpr std::size_t max_laser_rays = 1081;
inline constexpr std::size_t max_attached_sensors = 256;

/// A sensor that a robot's file puts on a link or a joint (<AttachedSensor>).
struct AttachedSensor {
  std::string name;
  SensorKind kind = SensorKind::touch;
  std::size_t part = 0;  ///< number of the link, of a servo_current of the joint; kernel order
  Pose pose;             ///< in the frame of the link
  /// Of a touch sensor: half the sides of the box, in the sensor's frame, in which contacts press it. Nothing: the
  /// whole link is the sensor.
  std::optional<Eigen::Vector3d> extents;
  /// The input of the link's module to which a touch sensor is wired, instead of the sensor under the link.
  std::optional<TouchInput> input;
  LaserScan scan;    ///< of a laser
  std::string file;  ///< where it is described, for messages
  int line = 0;
};

/// The name that files and recordings have for the kind.
[[nodiscard]] constexpr std::string_view name_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::touch:
      return "TactileSensor";
    case SensorKind::laser:
      return "BaseLaser2D";
    case SensorKind::servo_current:
      return "ServoCurrent";
    case SensorKind::inclinometer:
      return "Inclinometer";
    case SensorKind::accelerometer:
      break;
  }
  return "Accelerometer";
}

/// One number of a sensor.
struct SensorChannel {
  std::string name;
  std::string_view unit;  ///< "" for numbers without
};

/// The numbers of a sensor, in the order in which it gives them.
[[nodiscard]] inline std::vector<SensorChannel> channels_of(const AttachedSensor& sensor) {
  std::vector<SensorChannel> channels;
  switch (sensor.kind) {
    case SensorKind::touch:
      return {{"pressed", ""}, {"normal_x", ""}, {"normal_y", ""}, {"normal_z", ""}};
    case SensorKind::laser:
      for (std::size_t ray = 0; ray < sensor.scan.rays; ++ray) {
        channels.push_back({"distance_" + std::to_string(ray), "m"});
      }
      return channels;
    case SensorKind::servo_current:
      return {{"current", "mA"}};
    case SensorKind::inclinometer:
      return {{"pitch", "deg"}, {"roll", "deg"}};
    case SensorKind::accelerometer:
      break;
  }
  return {{"acceleration_x", "m/s^2"}, {"acceleration_y", "m/s^2"}, {"acceleration_z", "m/s^2"}};
}

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
