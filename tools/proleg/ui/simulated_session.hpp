#pragma once

// A simulated robot that viewers watch and change: that of a scenario, or the continued run of a recording. It runs in
// a thread of its own.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/proleg/ui/live_simulation.hpp"
#include "tools/proleg/ui/present_draft.hpp"
#include "tools/proleg/ui/recording_folder.hpp"
#include "tools/proleg/ui/repeated_run.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

/// When the ticks of a simulation are due, at a multiple of real time. A simulation that is late does not catch up in a
/// burst.
class RunPace {
 public:
  using Clock = std::chrono::steady_clock;
  /// More is a delay.
  static constexpr std::chrono::milliseconds tolerance{50};

  explicit RunPace(std::uint32_t tick_us) : tick_us_(tick_us) {}

  /// factor: simulated time by real time; 0: as fast as it goes.
  void set_factor(double factor, Clock::time_point now) {
    factor_ = factor;
    due_ = now;
  }
  [[nodiscard]] double factor() const { return factor_; }

  /// The run begins, or goes on after a pause.
  void begin(Clock::time_point now) {
    due_ = now;
    measured_from_ = now;
    ticks_ = 0;
  }
  /// When the next tick is due.
  [[nodiscard]] Clock::time_point due() const { return due_; }
  /// A tick was simulated.
  void tick_done(Clock::time_point now) {
    ++ticks_;
    if (factor_ > 0.0) {
      due_ +=
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::micro>(tick_us_ / factor_));
    }
    if (factor_ <= 0.0 || now > due_ + tolerance) {
      due_ = now;
    }
  }

  /// Simulated time by real time, since the last call or since begin().
  [[nodiscard]] double measure(Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - measured_from_).count();
    const double factor = seconds > 0.0 ? static_cast<double>(ticks_) * tick_us_ * 1e-6 / seconds : 0.0;
    measured_from_ = now;
    ticks_ = 0;
    return factor;
  }

 private:
  std::uint32_t tick_us_;
  double factor_ = 1.0;
  Clock::time_point due_{};
  Clock::time_point measured_from_{};
  std::uint64_t ticks_ = 0;
};

struct SimulatedSessionOptions {
  std::filesystem::path recordings;  ///< the folder of all recordings
  std::string command;               ///< that simulates the same scenario: "proleg simulate FILE ..."
  /// The same command for a copy of the scenario's files.
  std::function<std::string(const std::string& file)> command_of_copy = {};
  bool has_file = true;  ///< the files of the scenario are on disk
  std::string build_id;
  bool starts_paused = false;
  const PresentDraft* draft = nullptr;  ///< what `load_draft` simulates; null: nothing. Must outlive the session
};

class SimulatedSession final : private SessionThread {
 public:
  /// Carries out `requests`, and reports to `output`; both must outlive the session. live: null if there is no
  /// simulation until a recording is continued. Throws InputError if there is no folder of recordings.
  SimulatedSession(std::unique_ptr<LiveSimulation> live, SimulatedSessionOptions options, SessionRequests& requests,
                   host::SessionOutput& output);
  /// Ends the thread, and a recording.
  ~SimulatedSession() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"command_line", "file.diff", "ping"}; }

 private:
  enum class State : std::uint8_t { paused, running, stopped, failed };

  static constexpr std::chrono::milliseconds publish_period{500};

  // SessionThread
  void serve() override;
  /// Nothing moves until a restart.
  void fail(const std::string& why) override;
  void close() override { end_recording(); }
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  void wait();
  void stop_at_once();
  void tick();
  /// Publishes what viewers need of another simulation.
  void publish_robot();
  /// Compares the last tick with that of the recording that is continued.
  void check_repetition(const sim::TickSample& sample);
  void begin_recording(const std::string& file);
  void end_recording();
  [[nodiscard]] bool may_tick() const { return live_ != nullptr && (state_ == State::running || steps_left_ > 0); }
  void stop_steps();
  void set_state(State state);
  void publish_session(Clock::time_point now);
  void publish_changes();
  /// Refuses what has no meaning now.
  void require_possible(const std::string& operation) const;
  void require_sound() const;
  void require_saved_draft() const;
  void require_file() const;

  // The operations: take their arguments and return the value of the answer, or throw.
  using Handler = nlohmann::json (SimulatedSession::*)(const nlohmann::json&);
  nlohmann::json go_on(const nlohmann::json& arguments);
  nlohmann::json pause(const nlohmann::json& arguments);
  nlohmann::json step(const nlohmann::json& arguments);
  nlohmann::json restart(const nlohmann::json& arguments);
  nlohmann::json set_factor(const nlohmann::json& arguments);
  nlohmann::json set(const nlohmann::json& arguments);
  nlohmann::json undo(const nlohmann::json& arguments);
  nlohmann::json redo(const nlohmann::json& arguments);
  nlohmann::json swap(const nlohmann::json& arguments);
  nlohmann::json reset(const nlohmann::json& arguments);
  nlohmann::json move(const nlohmann::json& arguments);
  nlohmann::json record(const nlohmann::json& arguments);
  nlohmann::json continue_recording(const nlohmann::json& arguments);
  nlohmann::json tell_file_diff(const nlohmann::json& arguments);
  nlohmann::json apply_to_file(const nlohmann::json& arguments);
  nlohmann::json save_as(const nlohmann::json& arguments);
  nlohmann::json load_draft(const nlohmann::json& arguments);
  nlohmann::json ping(const nlohmann::json& arguments);
  nlohmann::json tell_command_line(const nlohmann::json& arguments);

  SimulatedSessionOptions options_;
  RecordingFolder folder_;

  // The members from here on are used on the session's thread only.
  std::unique_ptr<RepeatedRun> repeated_;  ///< the recording that is continued; it has the losses of the simulation
  bool is_repeating_ = false;              ///< its ticks are computed again
  bool is_unsaved_draft_ = false;          ///< the simulation is that of a draft that is not on disk
  std::unique_ptr<LiveSimulation> live_;
  RunPace pace_;
  State state_ = State::running;
  std::uint32_t steps_left_ = 0;
  std::uint16_t run_ = 1;
  std::string stopped_by_;
  std::string failure_;
  std::string recording_;
  std::vector<std::int32_t> row_;
  std::uint64_t published_revision_ = 0;
  bool is_session_new_ = true;
  Clock::time_point publish_at_{};
};

}  // namespace proleg::tools
