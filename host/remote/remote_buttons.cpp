#include "host/remote/remote_buttons.hpp"

#include <utility>

namespace proleg::host {

void RemoteButtons::set_allowed(RemoteTime now, bool is_allowed) {
  is_allowed_ = is_allowed;
  if (!is_allowed) {
    release_all(now);
  }
}

void RemoteButtons::press(RemoteAction action, const ElementPlace& element, const std::string& device_name) {
  if (action == RemoteAction::stop) {
    target_.stop(device_name);
    return;
  }
  const bool is_free = action == RemoteAction::pause || action == RemoteAction::hold_to_run;
  if (!is_allowed_ || (requires_hold_ && !is_free)) {
    return;
  }
  switch (action) {
    case RemoteAction::run:
      return target_.command(RobotCommand::run);
    case RemoteAction::pause:
      return target_.command(RobotCommand::pause);
    case RemoteAction::step:
      return target_.command(RobotCommand::step);
    case RemoteAction::restart:
      return target_.command(RobotCommand::restart);
    case RemoteAction::hold_to_run:
      if (held_.empty() || is_void_) {
        is_void_ = false;
        pausing_since_.reset();
        target_.command(RobotCommand::run);
      }
      held_.insert(element);
      return;
    case RemoteAction::stop:
      return;
  }
}

void RemoteButtons::release(RemoteTime now, const ElementPlace& element) {
  if (held_.erase(element) > 0) {
    end_hold_if_free(now);
  }
}

void RemoteButtons::release_device(RemoteTime now, DeviceId device) {
  if (std::erase_if(held_, [device](const ElementPlace& element) { return element.first == device; }) > 0) {
    end_hold_if_free(now);
  }
}

void RemoteButtons::release_all(RemoteTime now) {
  if (!held_.empty()) {
    held_.clear();
    end_hold_if_free(now);
  }
}

void RemoteButtons::robot_stopped() {
  is_void_ = !held_.empty();
  pausing_since_.reset();
}

void RemoteButtons::end_hold_if_free(RemoteTime now) {
  if (held_.empty() && (!std::exchange(is_void_, false) || target_.is_running())) {
    pausing_since_ = now;
    target_.command(RobotCommand::pause);
  }
}

void RemoteButtons::command_answered(RobotCommand command, bool is_ok) {
  if (command != RobotCommand::pause || !pausing_since_) {
    return;
  }
  if (is_ok) {
    pausing_since_.reset();
  } else {
    stop_unpaused();
  }
}

void RemoteButtons::stop_unpaused() {
  pausing_since_.reset();
  target_.stop("hold-to-run: the robot has not paused");
}

void RemoteButtons::advance(RemoteTime now) {
  if (pausing_since_ && now >= *pausing_since_ + pause_timeout) {
    stop_unpaused();
  }
}

std::optional<RemoteTime> RemoteButtons::due() const {
  return pausing_since_ ? std::optional(*pausing_since_ + pause_timeout) : std::nullopt;
}

}  // namespace proleg::host
