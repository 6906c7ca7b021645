#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/recorded_run.hpp"

namespace proleg::tools {

/// Whether two recordings have the same set-points, bit for bit, in the ticks that both have.
class RunComparison {
 public:
  /// Both must outlive this. Throws InputError if they cannot be compared tick by tick.
  RunComparison(RecordedRun& run, RecordedRun& other);

  [[nodiscard]] bool is_of(const RecordedRun& run) const { return runs_[0] == &run || runs_[1] == &run; }
  [[nodiscard]] bool is_of(const RecordedRun& run, const RecordedRun& other) const {
    return runs_[0] == &run && runs_[1] == &other;
  }
  /// Compares some further ticks; false: all that are known are compared, or a difference was found. Throws as
  /// Recording does.
  bool compare_some();
  /// It cannot go on: a file is damaged.
  void end(const std::string& why) { damage_ = why; }
  /// The value of `recording.compare` (docs/page-interface.md). Throws as Recording does.
  [[nodiscard]] nlohmann::json document();

 private:
  struct Difference {
    std::uint32_t tick;
    std::string joint;
  };

  [[nodiscard]] std::uint32_t first_tick() const;
  /// May be before first_tick(): no tick is in both.
  [[nodiscard]] std::uint32_t last_tick() const;

  std::array<RecordedRun*, 2> runs_;
  std::uint32_t compared_ = 0;  ///< ticks
  std::optional<Difference> difference_;
  std::optional<std::string> damage_;
  std::vector<std::int32_t> setpoints_;  ///< of some ticks of the first run
};

}  // namespace proleg::tools
