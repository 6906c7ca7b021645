#pragma once

// What bound elements of input devices do: they change parameters, and run and stop the robot.

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/remote/device_listener.hpp"

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

/// The value for a position of an element, before it is rounded to steps.
[[nodiscard]] double linear_value(const ParameterBinding& binding, ElementKind kind, double position);
/// The value rounded to whole steps from `lower`, at most `upper`.
[[nodiscard]] double stepped_value(const ParameterBinding& binding, double value);

/// The binding of an element to the parameters that it changes.
class ParameterMotion {
 public:
  struct Value {
    std::string parameter;
    double value;
  };

  ParameterMotion(ParameterBinding binding, ElementKind kind) : binding_(std::move(binding)), kind_(kind) {}

  /// Notes the position of an element that has not been moved; it has no effect.
  void place(double position);
  /// Notes that the element has been moved. Returns the values that it requests: nothing unless the stepped value has
  /// changed. begins: the element rested before; a parameter whose value differs from the one that the element gave it
  /// no longer follows the element.
  [[nodiscard]] std::vector<Value> move(double position, bool begins, const RemoteTarget& target);
  /// Detaches the element from all parameters until it has passed their values again.
  void let_go();

  [[nodiscard]] std::optional<double> value() const { return value_; }
  /// Whether each parameter follows the element.
  [[nodiscard]] std::vector<bool> taken() const;

 private:
  struct Follower {
    bool is_taken = false;
    double sent = 0;
  };

  /// Sets the stepped value for a position. Returns whether it has changed.
  bool step_to(double position);

  ParameterBinding binding_;
  ElementKind kind_;
  std::optional<double> value_;
  std::vector<Follower> followers_ = std::vector<Follower>(binding_.parameters.size());
};

/// Elements that run and stop the robot when they are pressed.
class RemoteButtons {
 public:
  /// Time for the robot to confirm the pause at the end of hold-to-run; it is stopped if it has not done so.
  static constexpr RemoteTime pause_timeout{500};

  explicit RemoteButtons(RemoteTarget& target) : target_(target) {}

  /// is_allowed: a viewer drives; otherwise only `stop` has an effect. When this ends, held buttons count as released.
  void set_allowed(RemoteTime now, bool is_allowed);
  /// is_required: only a held button may run the robot; `run`, `step` and `restart` have no effect.
  void require_hold(bool is_required) { requires_hold_ = is_required; }

  void press(RemoteAction action, const ElementPlace& element, const std::string& device_name);
  void release(RemoteTime now, const ElementPlace& element);
  /// Releases all elements of a device that has gone.
  void release_device(RemoteTime now, DeviceId device);
  void release_all(RemoteTime now);
  /// Notes that the robot was stopped: buttons that are held do not run it any more. Their release still pauses a
  /// robot that runs, because STOP and a press may have crossed.
  void robot_stopped();
  void command_answered(RobotCommand command, bool is_ok);
  void advance(RemoteTime now);
  [[nodiscard]] std::optional<RemoteTime> due() const;

 private:
  void end_hold_if_free(RemoteTime now);
  void stop_unpaused();

  RemoteTarget& target_;
  bool is_allowed_ = false;
  bool requires_hold_ = false;
  std::set<ElementPlace> held_;
  bool is_void_ = false;  ///< STOP was received while buttons were held
  std::optional<RemoteTime> pausing_since_;
};

}  // namespace proleg::host
