#pragma once

// A simulated robot that viewers watch and change. It runs in a thread of its own.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/server/session_output.hpp"
#include "host/server/session_requests.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/live_simulation.hpp"
#include "tools/proleg/ui/run_pace.hpp"

namespace proleg::tools {

struct SimulatedSessionOptions {
  std::filesystem::path recordings;   ///< the folder of all recordings
  std::string command;                ///< that simulates the same scenario: "proleg simulate FILE ..."
  std::vector<std::string> settings;  ///< words of --set that the runs begin with; the command has them too
  bool has_file = true;               ///< the files of the scenario are on disk
  std::string build_id;
  bool starts_paused = false;
};

class SimulatedSession {
 public:
  /// Does what `requests` has, and tells it `output`. scenario: as its files have it. scenario, losses, requests,
  /// output: must outlive the session. Throws as LiveSimulation does.
  SimulatedSession(const sim::Scenario& scenario, const sim::Losses* losses, SimulatedSessionOptions options,
                   host::SessionRequests& requests, host::SessionOutput& output);
  /// Ends the thread, and a recording.
  ~SimulatedSession();
  SimulatedSession(const SimulatedSession&) = delete;
  SimulatedSession& operator=(const SimulatedSession&) = delete;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"command_line", "file.diff", "ping"}; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t { paused, running, stopped, failed };

  static constexpr std::chrono::milliseconds publish_period{500};

  void run();
  void wait();
  void take_stops();
  void take_operations();
  /// Returns the value of the answer.
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation);
  void tick();
  void begin_recording(const std::string& file);
  void end_recording();
  [[nodiscard]] bool may_tick() const { return state_ == State::running || steps_left_ > 0; }
  void set_state(State state);
  void publish_session(Clock::time_point now);
  void publish_changes();
  void require_sound() const;
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
  nlohmann::json tell_file_diff(const nlohmann::json& arguments);
  nlohmann::json apply_to_file(const nlohmann::json& arguments);
  nlohmann::json ping(const nlohmann::json& arguments);
  nlohmann::json tell_command_line(const nlohmann::json& arguments);

  const sim::Scenario& file_;
  SimulatedSessionOptions options_;
  host::SessionRequests& requests_;
  host::SessionOutput& output_;

  // Of the thread.
  LiveSimulation live_;
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

  std::thread thread_;  ///< the last to begin
};

}  // namespace proleg::tools
