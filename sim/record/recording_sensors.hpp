#pragma once

// The tables of sensors in a recording.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/record/recorded_run.hpp"

namespace proleg::sim {

/// The sensors; none in a recording of an older program. links: number of them. Throws Damage.
[[nodiscard]] std::vector<RecordedSensor> read_sensor_tables(Database& database, std::size_t links);

/// Reads the values of all sensors, tick by tick. Sensors that did not measure in a tick keep their values.
class SensorRows {
 public:
  /// values: gets room for all channels, and what was measured before the first tick. sensors: must outlive this.
  SensorRows(Database& database, const std::vector<RecordedSensor>& sensors, std::uint32_t first, std::uint32_t last,
             std::vector<double>& values);

  /// Ticks must ascend. Throws Damage for rows that no recorder writes.
  void read(std::uint32_t tick, std::vector<double>& values);

 private:
  void take(std::vector<double>& values);

  const std::vector<RecordedSensor>& sensors_;
  std::optional<Statement> row_;  ///< nothing: there are no sensors
  bool has_row_ = false;
};

/// Reads what algorithms were given of their modules' sensors, tick by tick; nothing in a recording without them.
class ReadingRows {
 public:
  /// readings: gets an element for each of the joints.
  ReadingRows(Database& database, std::size_t joints, std::uint32_t first, std::uint32_t last,
              std::vector<JointReadings>& readings);

  /// Ticks must ascend. Throws Damage for rows that no recorder writes.
  void read(std::uint32_t tick, std::vector<JointReadings>& readings);

 private:
  std::optional<Statement> row_;
  bool has_row_ = false;
};

}  // namespace proleg::sim
