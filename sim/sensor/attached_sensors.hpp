#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// What a sensor measured in a run so far.
struct SensorSummary {
  std::string name;  ///< of the sensor
  SensorKind kind;
  std::string_view quantity;  ///< of quantities_of(kind)
  std::string_view unit;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  std::uint64_t count = 0;

  /// Mean of the samples; not a number before the first tick.
  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
};

/// The sensors that a robot's file attaches to it, in a simulated world. They measure without noise, at the end of
/// every tick; a laser at the end of each tick in which a scan is due.
class AttachedSensors {
 public:
  /// sensors: must outlive this. world: is told what it has to keep.
  AttachedSensors(const std::vector<AttachedSensor>& sensors, const Eigen::Vector3d& gravity, double step_s,
                  std::uint32_t tick_period_us, World& world);

  /// Called after each step of the world.
  void add_step(const World& world);
  /// Called after the last step of each tick. currents: of the servos, mA, means over the tick.
  void finish_tick(const World& world, std::span<const Pose> link_poses, std::span<const double> currents);
  /// The robot was put elsewhere and rests.
  void rest_at(std::span<const Pose> link_poses);

  /// All channels (channels_of) of the first sensor, then those of the next. Before the first tick: 0.
  [[nodiscard]] std::span<const double> values() const { return values_; }
  /// For each sensor, 1 if it measured in the last tick, otherwise 0: its values are older.
  [[nodiscard]] std::span<const std::uint8_t> measured() const { return measured_; }
  /// Puts the sensors that are wired to inputs of modules in the place of those under the links. link_contacts: per
  /// link, bit 0 rear, bit 1 front.
  void replace_inputs(std::span<std::uint8_t> link_contacts) const;
  [[nodiscard]] const std::vector<SensorSummary>& summaries() const { return summaries_; }

 private:
  struct Accelerometer {
    std::size_t sensor;
    Eigen::Vector3d place;  ///< in the world, after the last step
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_before = Eigen::Vector3d::Zero();  ///< at the start of the tick
  };
  /// Contacts in the steps of a tick.
  struct Touch {
    std::size_t sensor;
    bool is_pressed = false;
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();  ///< sum, in the world
  };
  [[nodiscard]] std::span<double> values_of(std::size_t sensor) {
    return std::span(values_).subspan(first_[sensor], first_[sensor + 1] - first_[sensor]);
  }
  void note_contacts(Touch& touch, const World& world) const;
  static void measure_touch(Touch& touch, std::span<double> out);
  void scan(const AttachedSensor& sensor, const Pose& pose, const World& world, std::span<double> out) const;
  void measure_inclination(const Pose& pose, std::span<double> out) const;
  void measure_acceleration(Accelerometer& sensor, const Pose& pose, std::span<double> out) const;
  void summarise(std::size_t sensor);

  const std::vector<AttachedSensor>& sensors_;
  Eigen::Vector3d gravity_;
  double step_s_;
  std::uint32_t tick_period_us_;
  std::uint64_t ticks_ = 0;
  std::vector<std::size_t> first_;  ///< of each sensor, the position of its values; then their number
  std::vector<double> values_;
  std::vector<std::uint8_t> measured_;
  std::vector<std::uint64_t> next_scan_us_;  ///< by sensor; lasers only
  std::vector<Accelerometer> accelerometers_;
  std::vector<Touch> touches_;
  std::vector<SensorSummary> summaries_;
  std::vector<std::size_t> first_summary_;  ///< by sensor
};

}  // namespace proleg::sim
