#include "sim/loop/module_readings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace proleg::sim {
namespace {

// Values of a joint's sensors.
constexpr std::size_t values_of_joint = 5;
constexpr std::size_t pitch = 0;
constexpr std::size_t roll = 1;
constexpr std::size_t acceleration = 2;

std::uint8_t needed_by(const Scenario& scenario) {
  unsigned needed = 0;
  for (const Slot& slot : scenario.kernel.slots) {
    needed |= slot.algorithm == nullptr ? 0U : unsigned{slot.algorithm->senses_readings()};
  }
  return static_cast<std::uint8_t>(needed);
}

std::vector<AttachedSensor> models_for(const Scenario& scenario, unsigned needed) {
  std::vector<AttachedSensor> models;
  if ((needed & (JointReadings::inclination | JointReadings::acceleration)) == 0) {
    return models;
  }
  for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
    AttachedSensor sensor;
    sensor.part = joint + 1;
    sensor.pose.position = scenario.robot.links[joint + 1].mass.center;
    for (const SensorKind kind : {SensorKind::inclinometer, SensorKind::accelerometer}) {
      sensor.kind = kind;
      models.push_back(sensor);
    }
  }
  return models;
}

/// 90 degrees = 2^30; 180 degrees wrap.
std::int32_t binary_angle(double degrees) {
  constexpr double per_degree = (1U << 30U) / 90.0;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(std::llround(degrees * per_degree)));
}

std::int32_t in_mm(double metres) {
  constexpr double largest = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::llround(std::clamp(metres * 1e3, -largest, largest)));
}

}  // namespace

ModuleReadings::ModuleReadings(const Scenario& scenario, World& world)
    : needed_(needed_by(scenario)),
      models_(models_for(scenario, needed_)),
      sensors_(models_, scenario.environment.gravity, scenario.step_s, scenario.kernel.tick_period_us, world) {}

JointReadings ModuleReadings::of(std::size_t joint, const ServoReadings& servo) const {
  constexpr std::uint16_t max_current_ma = 0x7FFF;  // as a module reports it
  JointReadings readings;
  readings.present = JointReadings::servo_current;
  readings.current_ma = std::min(servo.current_ma, max_current_ma);
  if (servo.angle) {
    readings.present |= JointReadings::angle_of_joint;
    readings.angle = *servo.angle;
  }
  if (!models_.empty()) {
    readings.present |= JointReadings::inclination | JointReadings::acceleration;
    const auto values = sensors_.values().subspan(values_of_joint * joint, values_of_joint);
    readings.pitch = binary_angle(values[pitch]);
    readings.roll = binary_angle(values[roll]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      readings.acceleration_mm_s2[axis] = in_mm(values[acceleration + axis]);
    }
  }
  return readings.only(needed_);
}

}  // namespace proleg::sim
