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

/// The robot that a remote control drives. No function waits; answers are sent to RemoteControl.
class RemoteTarget {
 public:
  virtual ~RemoteTarget() = default;

  /// Sets values at one tick. words: arguments as for --set. Sets with the same gesture are one entry for undo. The
  /// answer is RemoteControl::set_answered().
  virtual void set(const std::vector<std::string>& words, std::uint64_t gesture) = 0;
  /// Sends a command. The answer is RemoteControl::command_answered().
  virtual void command(RobotCommand command) = 0;
  virtual void stop(const std::string& by) = 0;
  /// The requested value of a parameter; that of its first joint, if the name means several. Nothing without a robot.
  [[nodiscard]] virtual std::optional<double> present(const std::string& parameter) const = 0;
  /// Whether the robot runs or is about to run, by its last report.
  [[nodiscard]] virtual bool is_running() const = 0;
};

}  // namespace proleg::host
