#pragma once

#include <optional>
#include <set>
#include <string>

#include "host/remote/binding.hpp"
#include "host/remote/device_listener.hpp"
#include "host/remote/remote_target.hpp"

namespace proleg::host {

/// Elements that run and stop the robot when they are pressed.
class RemoteButtons {
 public:
  /// A robot that has not confirmed the pause at the end of hold-to-run by then is stopped.
  static constexpr RemoteTime pause_timeout{500};

  explicit RemoteButtons(RemoteTarget& target) : target_(target) {}

  /// Somebody drives; else only `stop` has an effect. When this ends, what is held is let go.
  void set_allowed(RemoteTime now, bool is_allowed);
  /// A robot that only a held button may run: `run`, `step` and `restart` have no effect.
  void require_hold(bool is_required) { requires_hold_ = is_required; }

  void press(RemoteAction action, const ElementPlace& element, const std::string& device_name);
  void release(RemoteTime now, const ElementPlace& element);
  /// The device has gone: everything of it is released.
  void release_device(RemoteTime now, DeviceId device);
  void release_all(RemoteTime now);
  /// Somebody has stopped the robot: what is held does not run it any more. Its release pauses a robot that runs all
  /// the same: STOP and a press may have crossed.
  void robot_stopped();
  void command_answered(RobotCommand command, bool is_ok);
  void advance(RemoteTime now);
  [[nodiscard]] std::optional<RemoteTime> due() const;
  [[nodiscard]] bool is_holding() const { return !held_.empty(); }

 private:
  void end_hold_if_free(RemoteTime now);
  void stop_unpaused();

  RemoteTarget& target_;
  bool is_allowed_ = false;
  bool requires_hold_ = false;
  std::set<ElementPlace> held_;
  bool is_void_ = false;  ///< STOP came while they were held
  std::optional<RemoteTime> pausing_since_;
};

}  // namespace proleg::host
