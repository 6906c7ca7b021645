#include "tools/proleg/ui/ghost.hpp"

#include <exception>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/robot/mirror.hpp"

namespace proleg::tools {

Ghost::Ghost(const sim::Scenario& scenario) : scenario_(scenario), thread_([this] { run(); }) {}

Ghost::~Ghost() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Ghost::follow(std::uint32_t tick, std::vector<sim::ServoPulse> pulses) {
  const std::lock_guard lock(mutex_);
  if (has_failed_) {
    return;
  }
  if (ticks_.size() >= max_waiting) {
    fail("this computer simulates the robot more slowly than it moves");
    return;
  }
  ticks_.push_back({tick, std::move(pulses)});
  wake_.notify_one();
}

std::optional<Ghost::State> Ghost::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::optional<std::string> Ghost::take_failure() {
  const std::lock_guard lock(mutex_);
  return std::exchange(failure_, std::nullopt);
}

void Ghost::run() {
  try {
    Mirror mirror(scenario_);
    while (const std::optional<Tick> next_tick = next()) {
      sim::TickSample sample{};
      sample.tick = next_tick->tick;
      sample.servo_pulses = next_tick->pulses;
      const sim::TickSample simulated = mirror.follow(sample);
      State state{{simulated.link_poses.begin(), simulated.link_poses.end()},
                  {simulated.joint_angles.begin(), simulated.joint_angles.end()},
                  {simulated.motor_torques.begin(), simulated.motor_torques.end()},
                  {simulated.contact_forces.begin(), simulated.contact_forces.end()}};
      const std::lock_guard lock(mutex_);
      if (!has_failed_) {
        state_ = std::move(state);
      }
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    fail(one_line(error.what()));
  }
}

std::optional<Ghost::Tick> Ghost::next() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return ends_ || !ticks_.empty(); });
  if (ends_) {
    return std::nullopt;
  }
  Tick tick = std::move(ticks_.front());
  ticks_.pop_front();
  return tick;
}

/// The mutex is locked.
void Ghost::fail(const std::string& why) {
  has_failed_ = true;
  failure_ = "there is no simulation beside the robot any more: " + why;
  state_.reset();
  ticks_.clear();
}

}  // namespace proleg::tools
