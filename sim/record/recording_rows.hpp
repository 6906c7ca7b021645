#pragma once

// Checked values of the rows of a recording, the tables of its sensors, and one line for everything that can be wrong
// with the file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/fixed/unit.hpp"
#include "sim/record/recorded_run.hpp"

namespace proleg::sim {

inline constexpr const char* recording_expected = "a recording of proleg simulate or proleg hil";

/// The file is no valid recording. what() is what was found; reading() adds the path and makes it an InputError.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Columns of the current row. All throw Damage for a value that a recorder does not write.
[[nodiscard]] std::int32_t raw(const Statement& row, int column);
[[nodiscard]] std::uint32_t natural(const Statement& row, int column);
/// Microseconds after the start.
[[nodiscard]] std::uint64_t time(const Statement& row, int column);
[[nodiscard]] double finite(const Statement& row, int column);

/// The unit with this symbol. Phases are given as degrees, which have the same symbol and are written alike.
[[nodiscard]] Unit unit_of(const std::string& symbol);

/// Throws Damage if the file is shorter than the database says. (A query that does not read the last page would
/// succeed.) A file with a write-ahead log beside it may be shorter.
void require_whole_file(Database& database, const std::filesystem::path& path);

/// A whole number; name: for the message.
[[nodiscard]] std::uint32_t number(const std::string& text, const char* name);

/// The error that a user gets for an error of SQLite: InputError if the file is no recording, else FileError.
[[noreturn]] void throw_for_user(const std::filesystem::path& path, const SqliteError& error);

/// Runs an action that reads, and returns its result. Throws InputError and FileError for the user.
template <typename Action>
auto reading(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const Damage& damage) {
    throw InputError(path.string(), 0, damage.what(), recording_expected);
  } catch (const SqliteError& error) {
    throw_for_user(path, error);
  }
}

/// One of the tables that grow with the ticks, read in the order of its key.
class Rows {
 public:
  Rows(Database& database, const char* table, const char* sql, std::uint32_t first, std::uint32_t last)
      : table_(table), row_(database, sql) {
    row_.bind_all(first, last);
  }

  /// Steps to the row of this tick whose further key columns have these values.
  template <typename... Keys>
  const Statement& expect(std::uint32_t tick, Keys... keys) {
    int column = 0;
    if (!row_.step() || natural(row_, column) != tick || (... || (natural(row_, ++column) != keys))) {
      throw Damage(std::string("a gap in the table ") + table_ + " at tick " + std::to_string(tick));
    }
    return row_;
  }

 private:
  const char* table_;
  Statement row_;
};

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
