#include "tools/proleg/ui/joint_targets.hpp"

#include <algorithm>
#include <utility>

namespace proleg::tools {

JointTargets::JointTargets(std::span<const AngleLimits> limits, std::uint32_t tick_us)
    : positions_(limits.size()), tick_us_(tick_us) {
  for (const AngleLimits& limit : limits) {
    joints_.push_back({limit.lower, limit.upper});
  }
}

void JointTargets::place(unsigned joint, std::int32_t position) {
  positions_[joint] = position;
  joints_[joint].goal = position;
}

void JointTargets::go_to(unsigned joint, std::int32_t goal, double speed) {
  constexpr double raw_per_degree = (1 << 30) / 90.0;
  Joint& moved = joints_[joint];
  moved.goal = std::clamp(goal, moved.lower, moved.upper);
  moved.step = std::max<std::int64_t>(1, static_cast<std::int64_t>(speed * raw_per_degree * tick_us_ * 1e-6));
}

void JointTargets::halt() {
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    joints_[joint].goal = positions_[joint];
  }
}

void JointTargets::advance() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const std::int64_t way = std::int64_t{joint.goal} - positions_[i];
    if (way != 0) {
      positions_[i] = static_cast<std::int32_t>(positions_[i] + std::clamp(way, -joint.step, joint.step));
      joint.has_moved = true;
    }
  }
}

std::vector<unsigned> JointTargets::take_moved(std::size_t at_most) {
  std::vector<unsigned> moved;
  for (std::size_t looked = 0; looked < joints_.size() && moved.size() < at_most; ++looked) {
    if (std::exchange(joints_[turn_].has_moved, false)) {
      moved.push_back(static_cast<unsigned>(turn_));
    }
    turn_ = (turn_ + 1) % joints_.size();
  }
  return moved;
}

}  // namespace proleg::tools
