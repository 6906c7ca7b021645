#include "sim/record/recording_rows.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {

std::int32_t raw(const Statement& row, int column) {
  const std::int64_t value = row.integer(column);
  if (!row.is_integer(column) || value < std::numeric_limits<std::int32_t>::min() ||
      value > std::numeric_limits<std::int32_t>::max()) {
    throw Damage("a value that is not a 32-bit integer");
  }
  return static_cast<std::int32_t>(value);
}

std::uint32_t natural(const Statement& row, int column) {
  const std::int32_t value = raw(row, column);
  if (value < 0) {
    throw Damage("a negative number where ticks, joints and links are counted");
  }
  return static_cast<std::uint32_t>(value);
}

std::uint64_t time(const Statement& row, int column) {
  const std::int64_t value = row.integer(column);
  if (!row.is_integer(column) || value < 0) {
    throw Damage("a time that is not a whole number of microseconds after the start");
  }
  return static_cast<std::uint64_t>(value);
}

double finite(const Statement& row, int column) {
  const double value = row.real(column);
  if (!row.is_real(column) || !std::isfinite(value)) {
    throw Damage("a value that is not a finite number");
  }
  return value;
}

Unit unit_of(const std::string& symbol) {
  for (const Unit unit : {Unit::degree, Unit::hertz, Unit::per_second, Unit::ratio, Unit::count}) {
    if (symbol == scale_of(unit).symbol) {
      return unit;
    }
  }
  throw Damage("the unknown unit '" + symbol + "'");
}

std::uint32_t number(const std::string& text, const char* name) {
  const std::optional<std::uint32_t> value = parse_whole<std::uint32_t>(text);
  if (!value) {
    throw Damage(std::string("'") + text + "' as " + name);
  }
  return *value;
}

void throw_for_user(const std::filesystem::path& path, const SqliteError& error) {
  switch (error.code()) {
    case SQLITE_NOTADB:
      throw InputError(path.string(), 0, "something that is not a database", recording_expected);
    case SQLITE_CORRUPT:
      throw InputError(path.string(), 0, std::string("a damaged file (") + error.what() + ")", recording_expected);
    case SQLITE_ERROR:  // no such table or column
      throw InputError(path.string(), 0, error.what(), recording_expected);
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
      throw FileError(
          path, std::string("cannot be read (") + error.what() +
                    "); a recording that was not finished needs its -wal file and a folder with write permission");
    default:
      throw FileError(path, std::string("cannot be read: ") + error.what());
  }
}

void require_whole_file(Database& database, const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || std::filesystem::exists(path.string() + "-wal", error)) {
    return;
  }
  Statement pages(database, "SELECT page_count * page_size FROM pragma_page_count, pragma_page_size");
  if (pages.step() && static_cast<std::uint64_t>(pages.integer(0)) > size) {
    throw Damage("a file of " + std::to_string(size) + " bytes of a database of " + std::to_string(pages.integer(0)));
  }
}

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
  const bool has_angle =
      Statement(database, "SELECT 1 FROM pragma_table_info('reading') WHERE name = 'angle_raw'").step();
  const std::string sql = std::string(
                              "SELECT tick, joint, present, current_ma, pitch_raw, roll_raw, "
                              "acceleration_x_mm_s2, acceleration_y_mm_s2, acceleration_z_mm_s2, ") +
                          (has_angle ? "angle_raw" : "0") +
                          " FROM reading WHERE tick BETWEEN ?1 AND ?2 ORDER BY tick, joint";
  row_.emplace(database, sql);
  row_->bind_all(first, last);
  has_row_ = row_->step();
}

void ReadingRows::read(std::uint32_t tick, std::vector<JointReadings>& readings) {
  if (row_) {
    readings.assign(readings.size(), {});
  }
  for (; has_row_ && natural(*row_, 0) <= tick; has_row_ = row_->step()) {
    const std::uint32_t joint = natural(*row_, 1);
    if (joint >= readings.size() || natural(*row_, 2) > JointReadings::all_sensors) {
      throw Damage("readings of joint " + std::to_string(joint) + " of " + std::to_string(readings.size()));
    }
    readings[joint] = {static_cast<std::uint8_t>(natural(*row_, 2)),  raw(*row_, 3), raw(*row_, 4), raw(*row_, 5),
                       {raw(*row_, 6), raw(*row_, 7), raw(*row_, 8)}, raw(*row_, 9)};
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
