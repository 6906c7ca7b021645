#include "sim/record/recording_sensors.hpp"

#include <string>

#include "sim/record/recording_rows.hpp"
#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {

std::vector<RecordedSensor> read_sensor_tables(Database& database, std::size_t links) {
  std::vector<RecordedSensor> sensors;
  if (!Statement(database, "SELECT 1 FROM sqlite_schema WHERE name = 'sensor'").step()) {
    return sensors;
  }
  Statement row(database, "SELECT sensor, name, type, part FROM sensor ORDER BY sensor");
  Statement channel(database, "SELECT channel, name, unit FROM sensor_channel WHERE sensor = ?1 ORDER BY channel");
  std::size_t first_value = 0;
  while (row.step()) {
    const std::string type = row.text(2);
    const std::optional<SensorKind> kind = find_sensor_kind(type);
    if (natural(row, 0) != sensors.size() || sensors.size() == max_attached_sensors || !kind) {
      throw Damage("sensors that are not numbered from 0, or one of an unknown type");
    }
    RecordedSensor sensor{row.text(1), *kind, natural(row, 3), {}, first_value};
    for (channel.bind_all(natural(row, 0)); channel.step();) {
      if (natural(channel, 0) != sensor.channels.size() || sensor.channels.size() == max_laser_rays) {
        throw Damage("channels of sensor " + std::to_string(sensors.size()) + " that are not numbered from 0");
      }
      sensor.channels.push_back({channel.text(1), channel.text(2)});
    }
    AttachedSensor model;
    model.kind = *kind;
    model.scan.rays = sensor.channels.size();
    if (sensor.part >= links || sensor.channels.empty() || channels_of(model).size() != sensor.channels.size()) {
      throw Damage("sensor " + std::to_string(sensors.size()) + " with " + std::to_string(sensor.channels.size()) +
                   " channels at part " + std::to_string(sensor.part));
    }
    first_value += sensor.channels.size();
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

SensorRows::SensorRows(Database& database, const std::vector<RecordedSensor>& sensors, std::uint32_t first,
                       std::uint32_t last, std::vector<double>& values)
    : sensors_(sensors) {
  if (sensors.empty()) {
    return;
  }
  values.assign(sensors.back().first_value + sensors.back().channels.size(), 0.0);
  Statement before(database,
                   "SELECT tick, sensor, channel, value FROM sensor_value WHERE sensor = ?1 AND tick = "
                   "(SELECT max(tick) FROM sensor_value WHERE sensor = ?1 AND tick < ?2)");
  for (std::uint32_t sensor = 0; first > 0 && sensor < sensors.size(); ++sensor) {
    for (before.bind_all(sensor, first); before.step();) {
      const std::uint32_t channel = natural(before, 2);
      if (channel >= sensors[sensor].channels.size()) {
        throw Damage("channel " + std::to_string(channel) + " of sensor " + std::to_string(sensor));
      }
      values[sensors[sensor].first_value + channel] = finite(before, 3);
    }
  }
  row_.emplace(database,
               "SELECT tick, sensor, channel, value FROM sensor_value WHERE tick BETWEEN ?1 AND ?2 "
               "ORDER BY tick, sensor, channel");
  row_->bind_all(first, last);
  has_row_ = row_->step();
}

void SensorRows::read(std::uint32_t tick, std::vector<double>& values) {
  while (has_row_ && natural(*row_, 0) <= tick) {
    take(values);
    has_row_ = row_->step();
  }
}

ReadingRows::ReadingRows(Database& database, std::size_t joints, std::uint32_t first, std::uint32_t last,
                         std::vector<JointReadings>& readings) {
  readings.assign(joints, {});
  if (!Statement(database, "SELECT 1 FROM sqlite_schema WHERE name = 'reading'").step()) {
    return;
  }
  row_.emplace(
      database,
      "SELECT tick, joint, present, current_ma, pitch_raw, roll_raw, acceleration_x_mm_s2, "
      "acceleration_y_mm_s2, acceleration_z_mm_s2 FROM reading WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, joint");
  row_->bind_all(first, last);
  has_row_ = row_->step();
}

void ReadingRows::read(std::uint32_t tick, std::vector<JointReadings>& readings) {
  if (row_) {
    readings.assign(readings.size(), {});
  }
  for (; has_row_ && natural(*row_, 0) <= tick; has_row_ = row_->step()) {
    const std::uint32_t joint = natural(*row_, 1);
    if (joint >= readings.size() || natural(*row_, 2) > 7) {
      throw Damage("readings of joint " + std::to_string(joint) + " of " + std::to_string(readings.size()));
    }
    readings[joint] = {static_cast<std::uint8_t>(natural(*row_, 2)),
                       raw(*row_, 3),
                       raw(*row_, 4),
                       raw(*row_, 5),
                       {raw(*row_, 6), raw(*row_, 7), raw(*row_, 8)}};
  }
}

void SensorRows::take(std::vector<double>& values) {
  const std::uint32_t sensor = natural(*row_, 1);
  const std::uint32_t channel = natural(*row_, 2);
  if (sensor >= sensors_.size() || channel >= sensors_[sensor].channels.size()) {
    throw Damage("a value of channel " + std::to_string(channel) + " of sensor " + std::to_string(sensor));
  }
  values[sensors_[sensor].first_value + channel] = finite(*row_, 3);
}

}  // namespace proleg::sim
