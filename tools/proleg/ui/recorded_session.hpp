#pragma once

// The recordings that viewers look at: lists a folder, opens files, answers with rows, and compares two of them. It
// runs in a thread of its own, beside a robot.

#include <array>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/recorded_run.hpp"
#include "tools/proleg/ui/recording_folder.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// Whether two recordings have the same set-points, and their simulated worlds the same motion, bit for bit, in the
/// ticks that both have.
class RunComparison {
 public:
  /// Both must outlive this. Throws InputError if they cannot be compared tick by tick.
  RunComparison(RecordedRun& run, RecordedRun& other);

  [[nodiscard]] bool is_of(const RecordedRun& run) const { return runs_[0] == &run || runs_[1] == &run; }
  [[nodiscard]] bool is_of(const RecordedRun& run, const RecordedRun& other) const {
    return runs_[0] == &run && runs_[1] == &other;
  }
  /// Compares some further ticks; false: all that are known are compared, or the first differences of both kinds were
  /// found. Throws as Recording does.
  bool compare_some();
  /// Ends the comparison, because a file is damaged.
  void end(const std::string& why) { damage_ = why; }
  /// The value of `recording.compare` (docs/page-interface.md). Throws as Recording does.
  [[nodiscard]] nlohmann::json document();

 private:
  struct Difference {
    std::uint32_t tick;
    std::string joint;
  };

  void compare(const sim::RecordedTick& tick, const sim::RecordedTick& other);
  [[nodiscard]] bool is_decided() const { return difference_ && (moved_ || !has_motion_); }
  [[nodiscard]] std::uint32_t first_tick() const;
  /// May be before first_tick(): no tick is in both.
  [[nodiscard]] std::uint32_t last_tick() const;

  std::array<RecordedRun*, 2> runs_;
  std::uint32_t compared_ = 0;  ///< ticks
  bool has_motion_;             ///< both robots were simulated
  std::optional<Difference> difference_;
  std::optional<sim::MotionDifference> moved_;
  std::string moved_part_;
  std::optional<std::string> damage_;
  std::vector<sim::RecordedTick> ticks_;  ///< of the first run, a few
};

struct RecordedSessionOptions {
  std::filesystem::path folder;
  std::optional<std::string> file;  ///< recording in the folder that viewers open at once
  bool is_alone = false;            ///< there is no robot until a recording is continued
};

class RecordedSession final : private SessionThread {
 public:
  static constexpr std::size_t max_open_runs = 6;
  static constexpr std::size_t max_comparisons = 2;

  /// Carries out `requests`, and reports to `output`, which both must outlive the session. Throws InputError if there
  /// is no such folder.
  RecordedSession(RecordedSessionOptions options, SessionRequests& requests, host::SessionOutput& output);
  ~RecordedSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() {
    return {"recording.list", "recording.open", "recording.rows", "recording.compare"};
  }

 private:
  struct OpenRun {
    std::filesystem::path path;
    std::unique_ptr<RecordedRun> run;
    bool may_have_more = true;  ///< ticks for the pyramid
  };

  struct OpenComparison {
    RunComparison comparison;
    bool may_have_more = true;  ///< ticks to compare
  };

  // SessionThread
  void serve() override;
  /// What is open stays open.
  void fail(const std::string& /*why*/) override {}
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  /// What nobody waits for; false: there is nothing to do.
  [[nodiscard]] bool work();
  /// Opens the recording that the argument names, if it is not open. Of more than max_open_runs the one that was used
  /// least recently is closed.
  [[nodiscard]] OpenRun& run_of(const nlohmann::json& arguments, const char* name = "file");
  void close_run(std::list<OpenRun>::iterator run);

  using Handler = nlohmann::json (RecordedSession::*)(const nlohmann::json&);
  nlohmann::json list(const nlohmann::json& arguments);
  nlohmann::json open(const nlohmann::json& arguments);
  nlohmann::json rows(const nlohmann::json& arguments);
  nlohmann::json compare(const nlohmann::json& arguments);

  RecordingFolder folder_;
  std::list<OpenRun> runs_;                ///< the last used first
  std::list<OpenComparison> comparisons_;  ///< of open runs, the last used first
};

}  // namespace proleg::tools
