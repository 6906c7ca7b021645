#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/gait/joint_readings.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/sensor/attached_sensors.hpp"

namespace proleg::sim {

/// Inclination and acceleration of the link behind each joint, for algorithms that read them. No cost without such an
/// algorithm.
class ModuleReadings {
 public:
  /// world: in which the robot is.
  ModuleReadings(const Scenario& scenario, World& world);

  void add_step(const World& world) { sensors_.add_step(world); }
  void finish_tick(const World& world, std::span<const Pose> link_poses) {
    sensors_.finish_tick(world, link_poses, {});
  }
  void rest_at(std::span<const Pose> link_poses) { sensors_.rest_at(link_poses); }

  /// Of the last tick. current_ma: of the joint's servo. Absent are those that no algorithm of the scenario reads.
  [[nodiscard]] JointReadings of(std::size_t joint, std::uint16_t current_ma) const;

 private:
  std::uint8_t needed_;  ///< bits of JointReadings::Sensor
  std::vector<AttachedSensor> models_;
  AttachedSensors sensors_;
};

}  // namespace proleg::sim
