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
  [[nodiscard]] bool is_holding() const { return !held_.empty(); }

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
