#include "host/remote/parameter_motion.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace proleg::host
