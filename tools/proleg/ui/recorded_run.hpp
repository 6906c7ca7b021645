#pragma once

// A recording that viewers look at: its rows, and the smallest and largest values of blocks of them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/server/telemetry.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Smallest and largest values of blocks of rows, so that a picture of a long recording needs as much reading as it has
/// pixels. The blocks are in a temporary file that ends with the object: the memory does not grow with the rows, and
/// nothing is written beside a recording.
class RowPyramid {
 public:
  /// Rows in a block of each level.
  static constexpr std::array<std::uint32_t, 4> block_rows{8, 64, 512, 4096};

  /// width: values in a row, at least 1. Throws std::system_error if there is no temporary file.
  explicit RowPyramid(std::size_t width);

  /// The next row. host::no_value counts for neither minimum nor maximum. Throws std::system_error if the file cannot
  /// grow.
  void add(std::span<const std::int32_t> row);
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

  /// Blocks of `stride` rows, from number `first` on, one behind the other: each its first row, then the minima, then
  /// the maxima; a value that no row of the block has is host::no_value. The last block may have fewer rows than the
  /// others. Throws std::invalid_argument if there are no such blocks, and std::system_error.
  [[nodiscard]] std::vector<std::int32_t> blocks(std::uint32_t stride, std::uint64_t first, std::uint64_t count) const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  [[nodiscard]] std::size_t block_size() const { return 3 * width_; }
  void merge(std::vector<std::int32_t>& block, std::span<const std::int32_t> row) const;

  std::size_t width_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::array<std::vector<std::int32_t>, block_rows.size()> last_;  ///< the block of each level that still grows
  std::uint64_t rows_ = 0;
};

/// A recording that viewers look at, finished or growing. It reads the file and never changes it.
class RecordedRun {
 public:
  /// Limits of a request for rows, and of each block of an answer.
  static constexpr std::uint32_t max_points = 2048;
  static constexpr std::size_t max_bytes = std::size_t{4} << 20U;

  /// The rows that a viewer requests: of some signals, from tick `from` to tick `to`, in at most `points` rows or
  /// blocks.
  struct Request {
    std::vector<std::string> signals;
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    std::uint32_t points = max_points;
  };

  /// Throws as Recording and scenario_of() do.
  explicit RecordedRun(std::filesystem::path path);

  /// What a viewer needs to show it (docs/page-interface.md, Recordings). Looks whether the file has grown. Throws as
  /// Recording does.
  [[nodiscard]] nlohmann::json documents();
  /// The bytes of the answer: rows, or blocks where the ticks are more than the points. Throws InputError, also if the
  /// file is damaged there.
  [[nodiscard]] std::vector<std::uint8_t> rows(const Request& request);

  /// Takes some further ticks into the pyramid; false: it has all ticks that are known. Throws as Recording does, and
  /// std::system_error.
  bool index_some();
  /// The pyramid cannot go on: the file is damaged.
  void end_index(const std::string& why) { damage_ = why; }

  /// Calls `use` for these ticks, in order. Throws as Recording does.
  void read_ticks(std::uint32_t first, std::uint32_t last, const std::function<void(const sim::RecordedTick&)>& use);
  /// Metres on the ground from where the head was after one tick to where it was after another. Nothing if that is not
  /// the robot's own way: its place was not measured, or a hand moved it. Throws as Recording does.
  [[nodiscard]] std::optional<double> head_way(std::uint32_t from, std::uint32_t to);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Names of the joints, from the head on.
  [[nodiscard]] std::vector<std::string> joint_names() const;
  /// Whether the poses are those of a simulated world.
  [[nodiscard]] bool has_world();
  /// The name of what moved otherwise. Throws as Recording does.
  [[nodiscard]] std::string part_name(const sim::MotionDifference& difference);
  [[nodiscard]] std::uint32_t tick_period_us() const { return tick_period_us_; }
  /// First and last tick of the file, as far as it had grown when it was last read.
  [[nodiscard]] std::uint32_t first_tick() const { return first_tick_; }
  [[nodiscard]] std::uint32_t last_tick() const { return last_tick_; }

  /// False if the file was replaced by another one since it was opened.
  [[nodiscard]] bool is_current() const;

 private:
  /// The numbers by which the system distinguishes files.
  struct Identity {
    std::uint64_t device = 0;
    std::uint64_t number = 0;
    bool operator==(const Identity&) const = default;
  };

  [[nodiscard]] static std::optional<Identity> identity_of(const std::filesystem::path& path);
  void note(const sim::Recording& recording);
  /// Calls `use` with the recording as it is now. One that grows is opened each time, so that its writer can shorten
  /// its log.
  template <typename Use>
  auto with_recording(const Use& use);
  [[nodiscard]] std::vector<std::size_t> columns_of(const std::vector<std::string>& signals) const;

  std::filesystem::path path_;
  std::optional<Identity> identity_;
  std::unique_ptr<sim::Recording> finished_;
  sim::Scenario scenario_;
  host::SignalLayout layout_;
  RowPyramid pyramid_;
  std::uint32_t tick_period_us_ = 0;
  std::uint32_t first_tick_ = 0;
  std::uint32_t last_tick_ = 0;
  std::optional<std::string> damage_;
  std::vector<std::int32_t> row_;
};

}  // namespace proleg::tools
