#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace proleg::host {

/// Time since any fixed moment, on a steady clock.
using RemoteTime = std::chrono::milliseconds;

enum class RobotCommand : std::uint8_t { run, pause, step, restart };

/// The robot that a remote control drives. Nothing waits: RemoteControl is told the answers.
class RemoteTarget {
 public:
  virtual ~RemoteTarget() = default;

  /// Words as for --set; all of them take effect at one tick. Sets with one gesture are one entry for undo. Answered
  /// with RemoteControl::set_answered().
  virtual void set(const std::vector<std::string>& words, std::uint64_t gesture) = 0;
  /// Answered with RemoteControl::command_answered().
  virtual void command(RobotCommand command) = 0;
  virtual void stop(const std::string& by) = 0;
  /// The value that is wanted for a parameter; of its first joint, if the name means several. Nothing without a robot.
  [[nodiscard]] virtual std::optional<double> present(const std::string& parameter) const = 0;
  /// Or is about to, as the robot has said last.
  [[nodiscard]] virtual bool is_running() const = 0;
};

}  // namespace proleg::host
