#include "sim/sensor/attached_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

/// Directions shorter than this have no direction.
constexpr double shortest = 1e-9;

/// The first scan sets the beat: the others follow it by whole periods, each at the end of the first tick that is not
/// earlier. scheduled: when this one was due; 0: it is the first.
std::uint64_t next_scan_after(std::uint64_t scheduled, std::uint64_t period, std::uint64_t now) {
  if (scheduled == 0 || period == 0) {
    return now + period;
  }
  return scheduled + ((now - scheduled) / period + 1) * period;
}

}  // namespace

AttachedSensors::AttachedSensors(const std::vector<AttachedSensor>& sensors, const Eigen::Vector3d& gravity,
                                 double step_s, std::uint32_t tick_period_us, World& world)
    : sensors_(sensors),
      gravity_(gravity),
      step_s_(step_s),
      tick_period_us_(tick_period_us),
      measured_(sensors_.size()),
      next_scan_us_(sensors_.size()) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const AttachedSensor& sensor = sensors_[i];
    first_.push_back(values_.size());
    values_.resize(values_.size() + channels_of(sensor).size());
    first_summary_.push_back(summaries_.size());
    for (const SensorQuantity& quantity : quantities_of(sensor.kind)) {
      summaries_.push_back({sensor.name, sensor.kind, quantity.name, quantity.unit});
    }
    if (sensor.kind == SensorKind::touch) {
      world.keep_contact_points();
      touches_.push_back({i});
    } else if (sensor.kind == SensorKind::accelerometer) {
      accelerometers_.push_back({i, world.link_pose(sensor.part) * sensor.pose.position});
    }
  }
  first_.push_back(values_.size());
}

void AttachedSensors::add_step(const World& world) {
  for (Accelerometer& sensor : accelerometers_) {
    const AttachedSensor& model = sensors_[sensor.sensor];
    const Eigen::Vector3d place = world.link_pose(model.part) * model.pose.position;
    sensor.velocity = (place - sensor.place) / step_s_;
    sensor.place = place;
  }
  for (Touch& touch : touches_) {
    note_contacts(touch, world);
  }
}

void AttachedSensors::finish_tick(const World& world, std::span<const Pose> link_poses,
                                  std::span<const double> currents) {
  ++ticks_;
  auto accelerometer = accelerometers_.begin();
  auto touch = touches_.begin();
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const AttachedSensor& sensor = sensors_[i];
    const std::span<double> out = values_of(i);
    measured_[i] = 1;
    if (sensor.kind == SensorKind::servo_current) {
      out[0] = currents[sensor.part];
      summarise(i);
      continue;
    }
    const Pose pose = link_poses[sensor.part] * sensor.pose;
    switch (sensor.kind) {
      case SensorKind::touch:
        measure_touch(*touch++, out);
        break;
      case SensorKind::laser: {
        const std::uint64_t now = ticks_ * tick_period_us_;
        measured_[i] = now >= next_scan_us_[i] ? 1 : 0;
        if (measured_[i] != 0) {
          scan(sensor, pose, world, out);
          next_scan_us_[i] = next_scan_after(next_scan_us_[i], sensor.scan.period_us, now);
        }
        break;
      }
      case SensorKind::inclinometer:
        measure_inclination(pose, out);
        break;
      default:
        measure_acceleration(*accelerometer++, pose, out);
        break;
    }
    if (measured_[i] != 0) {
      summarise(i);
    }
  }
}

void AttachedSensors::rest_at(std::span<const Pose> link_poses) {
  for (Accelerometer& sensor : accelerometers_) {
    const AttachedSensor& model = sensors_[sensor.sensor];
    sensor.place = link_poses[model.part] * model.pose.position;
    sensor.velocity = sensor.velocity_before = Eigen::Vector3d::Zero();
  }
  for (Touch& touch : touches_) {
    touch = {touch.sensor};
  }
}

void AttachedSensors::replace_inputs(std::span<std::uint8_t> link_contacts) const {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (const auto& input = sensors_[i].input) {
      std::uint8_t& contacts = link_contacts[sensors_[i].part];
      const unsigned bit = *input == TouchInput::rear ? 1U : 2U;
      contacts = static_cast<std::uint8_t>(values_[first_[i]] != 0.0 ? contacts | bit : contacts & ~bit);
    }
  }
}

void AttachedSensors::note_contacts(Touch& touch, const World& world) const {
  const AttachedSensor& sensor = sensors_[touch.sensor];
  if (world.contact_points().empty()) {
    return;
  }
  const Pose to_sensor = (world.link_pose(sensor.part) * sensor.pose).inverse();
  for (const LinkContact& contact : world.contact_points()) {
    if (contact.link == sensor.part &&
        (!sensor.extents || ((to_sensor * contact.point).cwiseAbs().array() <= sensor.extents->array()).all())) {
      touch.is_pressed = true;
      touch.normals += contact.normal;
    }
  }
}

void AttachedSensors::measure_touch(Touch& touch, std::span<double> out) {
  // Opposite normals, of a link that is jammed, have no direction.
  const bool has_direction = touch.normals.norm() > shortest;
  out[0] = touch.is_pressed ? 1.0 : 0.0;
  std::ranges::copy(has_direction ? touch.normals.normalized().eval() : Eigen::Vector3d::Zero().eval(),
                    out.begin() + 1);
  touch = {touch.sensor};
}

void AttachedSensors::scan(const AttachedSensor& sensor, const Pose& pose, const World& world,
                           std::span<double> out) const {
  for (std::size_t ray = 0; ray < sensor.scan.rays; ++ray) {
    const double angle = sensor.scan.first_angle + sensor.scan.angle_step * static_cast<double>(ray);
    const Eigen::Vector3d direction = pose.orientation * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    out[ray] =
        world.distance_along(pose.position, direction, sensor.scan.range, sensor.part).value_or(sensor.scan.range);
  }
}

void AttachedSensors::measure_inclination(const Pose& pose, std::span<double> out) const {
  const Eigen::Vector3d vertical =
      gravity_.norm() > shortest ? (-gravity_).normalized().eval() : Eigen::Vector3d::UnitZ().eval();
  const Eigen::Vector3d up = pose.orientation.conjugate() * vertical;
  // The last bit of std::hypot depends on the processor; that of a root does not.
  out[0] = std::atan2(up.y(), std::sqrt(up.x() * up.x() + up.z() * up.z())) * degrees_per_radian;
  out[1] = std::atan2(-up.x(), up.z()) * degrees_per_radian;
}

void AttachedSensors::measure_acceleration(Accelerometer& sensor, const Pose& pose, std::span<double> out) const {
  const Eigen::Vector3d acceleration = (sensor.velocity - sensor.velocity_before) / (tick_period_us_ * 1e-6);
  sensor.velocity_before = sensor.velocity;
  std::ranges::copy((pose.orientation.conjugate() * (acceleration - gravity_)).eval(), out.begin());
}

void AttachedSensors::summarise(std::size_t sensor) {
  const SensorKind kind = sensors_[sensor].kind;
  for (std::size_t quantity = 0; quantity < quantities_of(kind).size(); ++quantity) {
    SensorSummary& summary = summaries_[first_summary_[sensor] + quantity];
    const double value = quantity_of(kind, quantity, values_of(sensor));
    summary.least = std::min(summary.least, value);
    summary.greatest = std::max(summary.greatest, value);
    summary.sum += value;
    ++summary.count;
  }
}

}  // namespace proleg::sim
