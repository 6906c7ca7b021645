#include "sim/record/recording_rows.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"

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

}  // namespace proleg::sim
