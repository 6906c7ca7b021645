#include "tools/proleg/ui/robot_stops.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/power_state.hpp"

namespace proleg::tools {

RobotStops::RobotStops(const sim::Scenario& file, host::BusConnection& bus, host::SessionOutput& output)
    : file_(file), output_(output), queue_(bus), attachment_(bus, queue_), confirmed_(file.robot.joints.size()) {}

void RobotStops::give(const std::vector<SessionRequests::Stop>& stops, DrivenRobot* robot) {
  for (const SessionRequests::Stop& stop : stops) {
    pending_.push_back({stop.request, stop.since});
    output_.notice(host::NoticeLevel::warning, "stopped by " + stop.by);
  }
  std::ranges::fill(confirmed_, false);
  if (robot != nullptr) {
    robot->quick_stop([this](unsigned joint) { confirm(joint); });
    return;
  }
  for (unsigned joint = 0; joint < confirmed_.size(); ++joint) {
    queue_.write(file_.modules[joint].node, canopen::object::controlword.address, canopen::object::controlword.type,
                 canopen::quick_stop_controlword, [this, joint](const host::SdoResult& result) {
                   if (result.is_good()) {
                     confirm(joint);
                   }
                 });
  }
}

void RobotStops::answer() {
  const auto confirmed = static_cast<unsigned>(std::ranges::count(confirmed_, std::optional(true)));
  const Clock::time_point now = Clock::now();
  while (!pending_.empty() && (confirmed == confirmed_.size() || now > pending_.front().since + longest_confirmation)) {
    const Clock::time_point end = confirmed > 0 && last_confirmation_ ? *last_confirmation_ : now;
    output_.stopped(pending_.front().request, confirmed, static_cast<unsigned>(confirmed_.size()),
                    std::max(0.0, std::chrono::duration<double, std::milli>(end - pending_.front().since).count()));
    pending_.pop_front();
  }
}

void RobotStops::clear() { std::ranges::fill(confirmed_, std::nullopt); }

void RobotStops::confirm(unsigned joint) {
  confirmed_[joint] = true;
  last_confirmation_ = Clock::now();
}

}  // namespace proleg::tools
