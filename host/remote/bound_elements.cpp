#include "host/remote/bound_elements.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace proleg::host {

double linear_value(const ParameterBinding& binding, ElementKind kind, double position) {
  if (kind == ElementKind::button) {
    return position > 0 ? binding.upper : binding.lower;
  }
  const double beyond = std::max(0.0, (std::abs(position) - binding.dead_zone) / (1 - binding.dead_zone));
  const double curved = std::copysign(std::pow(std::min(beyond, 1.0), binding.curve), position);
  return binding.lower + (binding.upper - binding.lower) * (curved + 1) / 2;
}

double stepped_value(const ParameterBinding& binding, double value) {
  const double steps = std::round((value - binding.lower) / binding.step);
  const auto [low, high] = std::minmax(binding.lower, binding.upper);
  const double stepped = std::clamp(binding.lower + steps * binding.step, low, high);
  // The last step may be shorter than the others, so that the upper limit can be reached.
  return std::abs(value - binding.upper) < std::abs(value - stepped) ? binding.upper : stepped;
}

bool ParameterMotion::step_to(double position) {
  const double value = linear_value(binding_, kind_, position);
  const double stepped = stepped_value(binding_, value);
  if (!value_) {
    value_ = stepped;
    return false;
  }
  // Share of a step that a movement must exceed, so that a hand that trembles between two steps changes nothing.
  constexpr double enough_of_a_step = 0.6;
  const bool is_limit = stepped == binding_.lower || stepped == binding_.upper;
  if (stepped == *value_ || (!is_limit && std::abs(value - *value_) < enough_of_a_step * binding_.step)) {
    return false;
  }
  value_ = stepped;
  return true;
}

void ParameterMotion::place(double position) {
  value_.reset();
  step_to(position);
  let_go();
}

std::vector<ParameterMotion::Value> ParameterMotion::move(double position, bool begins, const RemoteTarget& target) {
  const std::optional<double> before = value_;
  if (!step_to(position) || !before) {
    return {};
  }
  std::vector<Value> values;
  for (std::size_t i = 0; i < followers_.size(); ++i) {
    Follower& follower = followers_[i];
    const std::string& parameter = binding_.parameters[i];
    if (binding_.take_up) {
      const std::optional<double> present = target.present(parameter);
      if (!present) {
        continue;
      }
      const double near = binding_.step / 2;
      if (begins && follower.is_taken && std::abs(*present - follower.sent) > near) {
        follower.is_taken = false;
      }
      const bool passes = (*before - *present) * (*value_ - *present) <= 0 || std::abs(*value_ - *present) <= near;
      follower.is_taken = follower.is_taken || passes;
      if (!follower.is_taken) {
        continue;
      }
    }
    follower.is_taken = true;
    follower.sent = *value_;
    values.push_back({parameter, *value_});
  }
  return values;
}

void ParameterMotion::let_go() {
  for (Follower& follower : followers_) {
    follower.is_taken = false;
  }
}

std::vector<bool> ParameterMotion::taken() const {
  std::vector<bool> taken;
  taken.reserve(followers_.size());
  for (const Follower& follower : followers_) {
    taken.push_back(follower.is_taken || !binding_.take_up);
  }
  return taken;
}

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
