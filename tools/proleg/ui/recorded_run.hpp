#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/server/signal_layout.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/row_pyramid.hpp"

namespace proleg::tools {

/// A recording that viewers look at, finished or growing. It reads the file and never changes it.
class RecordedRun {
 public:
  /// Of a request for rows, and for each block of an answer.
  static constexpr std::uint32_t max_points = 2048;
  static constexpr std::size_t max_bytes = std::size_t{4} << 20U;

  /// Which rows a viewer wants: of some signals, from tick `from` to tick `to`, in at most `points` rows or blocks.
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
  /// From the head.
  [[nodiscard]] std::vector<std::string> joint_names() const;
  [[nodiscard]] std::uint32_t tick_period_us() const { return tick_period_us_; }
  /// As far as the file had grown when it was last read.
  [[nodiscard]] std::uint32_t first_tick() const { return first_tick_; }
  [[nodiscard]] std::uint32_t last_tick() const { return last_tick_; }

  /// False if the file was replaced by another one since it was opened.
  [[nodiscard]] bool is_current() const;

 private:
  /// A file as the system tells them apart.
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
