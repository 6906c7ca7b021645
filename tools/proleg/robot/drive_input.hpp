#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {

/// Standard input of a program that moves a robot: changes that a person types, or the lines of a program that has
/// started this one.
class DriveInput {
 public:
  /// ends_the_run: the robot is to stop when no further line will come. longest_silence: it is to stop when no line has
  /// come for so many seconds. Throws InputError for another number than 0.1 to 60.
  DriveInput(bool ends_the_run, const std::optional<std::string>& longest_silence);

  /// Takes the next line, without its end; nothing if none has come yet. Does not wait.
  [[nodiscard]] std::optional<std::string> next();
  [[nodiscard]] bool has_ended() const { return ends_the_run_ && input_.has_ended(); }
  [[nodiscard]] bool is_silent();

 private:
  using Clock = std::chrono::steady_clock;

  void look();

  InputLines input_;
  bool ends_the_run_;
  std::optional<std::chrono::duration<double>> longest_silence_;
  Clock::time_point heard_at_ = Clock::now();
  std::deque<std::string> lines_;  ///< that have come and were not taken
};

}  // namespace proleg::tools
