#pragma once

// What sweeps have found, as the page shows it (docs/page-interface.md, Sweeps): read from their tables, which other
// programs may write meanwhile.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/sweep/sweep.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/sweep_folder.hpp"

namespace proleg::tools {

/// A cell is a combination without the seed; cells are counted as combinations are (optimize::Sweep). All functions
/// throw InputError for a sweep that cannot be read, and for a cell or a measure that does not exist. sweep: the folder
/// of a sweep.
class SweepResults {
 public:
  /// The value of `sweep.open`, without `name`.
  [[nodiscard]] nlohmann::json describe(const std::filesystem::path& sweep);
  /// The value of `sweep.cells`.
  [[nodiscard]] nlohmann::json cells(const std::filesystem::path& sweep, const std::optional<std::string>& measure,
                                     std::uint64_t from);
  /// The value of `sweep.cell`.
  [[nodiscard]] nlohmann::json cell(const std::filesystem::path& sweep, std::uint64_t number);
  /// The scenario of a cell, with the first seed.
  [[nodiscard]] sim::Scenario scenario_of(const std::filesystem::path& sweep, std::uint64_t number);

 private:
  using Clock = std::chrono::steady_clock;

  struct Cell {
    double mean;
    double deviation;
    std::uint64_t values = 0;
    std::uint64_t failed = 0;
  };
  /// The table that was read last.
  struct Table {
    std::filesystem::path sweep;
    std::uintmax_t size = 0;
    std::filesystem::file_time_type time;
    Clock::time_point next_look;  ///< a table that grows is not read all the time
    NotedSweep note;
    optimize::SweepTable content;
    std::optional<sim::Measure> measure;  ///< of the cells
    std::vector<Cell> cells;
  };

  const Table& table_of(const std::filesystem::path& sweep);
  void group(Table& table, sim::Measure measure);

  std::optional<Table> table_;
};

}  // namespace proleg::tools
