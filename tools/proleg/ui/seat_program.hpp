#pragma once

// The program of one seat of a class: a `proleg ui` of its own, with which a class talks in lines of JSON.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/common/child_program.hpp"

namespace proleg::tools {

/// To a program of a seat: first its settings, {"token": ..., "name": ..., "is_teacher": ..., "may_write_code": ...,
/// "is_open_to_network": ..., "limits": limits_json() or null, "page_program": build id of the class}, then
/// {"do": "stop", "number": 3}, {"do": "notice", "text": ...}, {"do": "hand_out", "file": ..., "title": ...}. From it:
/// {"port": 40123} when it is ready, and {"stopped": 3, "confirmed": 1, "of": 1}.
class SeatProgram {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class State : std::uint8_t { starting, ready, ended };

  struct Stopped {
    std::uint64_t number = 0;
    unsigned confirmed = 0;
    unsigned of = 0;
  };

  /// Starts it. command: with all arguments. folder: where it runs. Throws std::runtime_error.
  SeatProgram(const std::vector<std::string>& command, const std::filesystem::path& folder,
              const nlohmann::json& settings, Time now);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] std::optional<std::uint16_t> port() const { return state_ == State::ready ? port_ : std::nullopt; }
  /// Why it has ended; empty if it runs.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] Time started() const { return started_; }

  /// Reads what it has sent, and looks whether it has ended. Returns its answers to STOP.
  [[nodiscard]] std::vector<Stopped> poll(Time now);
  /// False: it takes no lines now.
  bool tell(const nlohmann::json& line) { return child_ != nullptr && child_->write_line(line.dump(-1, ' ', true)); }
  /// Asks it to end. The destructor waits until it has.
  void end();

 private:
  /// A program that is not ready in this time is ended.
  static constexpr std::chrono::seconds longest_start{20};

  void take_line(const std::string& line, std::vector<Stopped>& stopped);

  std::unique_ptr<ChildProgram> child_;
  State state_ = State::starting;
  std::optional<std::uint16_t> port_;
  std::string problem_;
  std::string rest_;         ///< of standard output: the beginning of a line
  std::string last_errors_;  ///< the end of what it wrote on standard error
  Time started_;
};

}  // namespace proleg::tools
