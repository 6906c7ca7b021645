#include "host/robot_control/gait_driver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <thread>
#include <utility>

namespace proleg::host {
namespace {

constexpr double right_angle_steps = 1 << 30;
/// Angle by which a servo that rests at a limit may measure more than the limit.
constexpr double limit_tolerance_deg = 3.0;
/// Time in which servos reach the end of a ramp after the last command.
constexpr std::uint32_t settle_time_us = 200'000;

double degrees(std::int32_t angle) { return angle * 90.0 / right_angle_steps; }

/// An angle within +-90 degrees as a set-point.
std::int32_t steps(double deg) {
  return static_cast<std::int32_t>(std::lround(std::clamp(deg, -90.0, 90.0) / 90.0 * right_angle_steps));
}

}  // namespace

GaitDriver::GaitDriver(RobotControl& control, SetpointSource& source, const DriveLimits& limits, std::uint32_t ticks,
                       Observer observer)
    : control_(control),
      source_(source),
      command_speed_(limits.command_speed),
      max_ticks_(ticks),
      observer_(std::move(observer)),
      limiters_(limits.lower.size()),
      commanded_deg_(limits.lower.size()),
      debouncers_(limits.lower.size()),
      contacts_(limits.lower.size()) {
  const RobotControlDescription& description = control.description();
  for (std::size_t joint = 0; joint < limiters_.size(); ++joint) {
    const std::int32_t lower = std::max(limits.lower[joint], steps(description.lower_limit_deg[joint]));
    const std::int32_t upper = std::min(limits.upper[joint], steps(description.upper_limit_deg[joint]));
    limiters_[joint].set_limits(lower, upper);
    lower_deg_.push_back(degrees(lower));
    upper_deg_.push_back(degrees(upper));
  }
}

void GaitDriver::start() {
  control_.connect();
  const std::vector<double> measured = control_.request_information("position");
  require_within_limits(measured);
  set_step(ramp_speed);
  for (std::size_t joint = 0; joint < limiters_.size(); ++joint) {
    limiters_[joint].release();
    static_cast<void>(limiters_[joint].next(steps(measured[joint])));
  }
  control_.enable_servos(true);
  phase_ = Phase::ramp_in;
}

void GaitDriver::require_within_limits(std::span<const double> measured_deg) const {
  for (std::size_t joint = 0; joint < measured_deg.size(); ++joint) {
    const double angle = measured_deg[joint];
    if (angle < lower_deg_[joint] - limit_tolerance_deg || angle > upper_deg_[joint] + limit_tolerance_deg) {
      throw RobotControlError("joint " + in_quotes(control_.setup().joints[joint].name) + " is at " +
                              number_text(std::round(angle * 10.0) / 10.0) + " degrees, expected " +
                              number_text(lower_deg_[joint]) + " to " + number_text(upper_deg_[joint]) +
                              "; move it there by hand, or correct its offset and direction in the robot's file");
    }
  }
}

void GaitDriver::set_step(std::uint32_t degrees_per_second) {
  for (MotionLimiter& limiter : limiters_) {
    limiter.set_step(MotionLimiter::step_of(degrees_per_second, tick_us()));
  }
}

bool GaitDriver::send(std::span<const std::int32_t> goals) {
  is_at_goal_ = true;
  for (std::size_t joint = 0; joint < limiters_.size(); ++joint) {
    const std::int32_t angle = limiters_[joint].next(goals[joint]);
    is_at_goal_ = is_at_goal_ && angle == limiters_[joint].within_limits(goals[joint]);
    commanded_deg_[joint] = degrees(angle);
  }
  control_.send_goal_positions(commanded_deg_);
  return is_at_goal_;
}

GaitDriver::Phase GaitDriver::tick() {
  if (phase_ == Phase::ramp_down) {
    ramp_down();
  } else if (phase_ == Phase::ramp_in || phase_ == Phase::gait) {
    attempt([&] { phase_ == Phase::gait ? play_gait() : ramp_in(); });
    if (control_.is_lost()) {
      phase_ = Phase::finished;
    } else if (failure_) {
      stop();
    }
  }
  return phase_;
}

void GaitDriver::ramp_in() {
  if (send(source_.setpoints())) {
    set_step(command_speed_);
    phase_ = Phase::gait;
  }
}

void GaitDriver::play_gait() {
  if (max_ticks_ != 0 && gait_ticks_ == max_ticks_) {
    stop();
    ramp_down();
    return;
  }
  read_contacts();
  source_.advance(contacts_);
  static_cast<void>(send(source_.setpoints()));
  const std::vector<double> measured = control_.request_information("position");
  for (std::size_t joint = 0; joint < measured.size(); ++joint) {
    max_difference_deg_ = std::max(max_difference_deg_, std::abs(measured[joint] - commanded_deg_[joint]));
  }
  if (observer_) {
    observer_({gait_ticks_, source_.setpoints(), measured});
  }
  ++gait_ticks_;
}

void GaitDriver::read_contacts() {
  if (control_.description().sensor_modules == 0) {
    return;
  }
  const std::vector<double> sensors = control_.request_information("contact");
  const auto link_bits = [&](std::size_t link) {
    return (sensors[2 * link] != 0.0 ? 1U : 0U) | (sensors[2 * link + 1] != 0.0 ? 2U : 0U);
  };
  for (std::size_t joint = 0; joint < contacts_.size(); ++joint) {
    const unsigned head = joint == 0 ? link_bits(0) << 2U : 0U;
    contacts_[joint] = debouncers_[joint].sample(static_cast<std::uint8_t>(link_bits(joint + 1) | head));
  }
}

void GaitDriver::stop() {
  if (phase_ == Phase::ramp_in || phase_ == Phase::gait) {
    set_step(ramp_speed);
    settle_ticks_ = settle_time_us / tick_us();
    phase_ = Phase::ramp_down;
  }
}

/// Ramps down also if a servo has failed: the others must not stop where they are.
void GaitDriver::ramp_down() {
  const std::vector<std::int32_t> middle(limiters_.size());
  attempt([&] { static_cast<void>(send(middle)); });
  if (control_.is_lost()) {
    phase_ = Phase::finished;
  } else if (is_at_goal_ && settle_ticks_-- == 0) {
    phase_ = Phase::finished;
    attempt([&] { control_.enable_servos(false); });
    attempt([&] { control_.disconnect(); });
  }
}

/// Runs an action and stores its failure if it is the first one, which is the cause of the later ones.
void GaitDriver::attempt(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    if (!failure_) {
      failure_ = error.what();
    }
  }
}

std::uint64_t SteadyClock::now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

void SteadyClock::sleep_until(std::uint64_t time_us) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(std::chrono::microseconds(time_us)));
}

DriveResult drive(GaitDriver& driver, Clock& clock, const std::function<bool()>& must_stop) {
  driver.start();
  DriveResult result;
  std::uint64_t next_us = clock.now_us();
  while (driver.phase() != GaitDriver::Phase::finished) {
    clock.sleep_until(next_us);
    const std::uint64_t now_us = clock.now_us();
    const std::uint64_t delay_us = now_us > next_us ? now_us - next_us : 0;
    result.max_delay_us = std::max(result.max_delay_us, delay_us);
    if (delay_us > driver.tick_us()) {
      ++result.late_ticks;
      next_us = now_us;  // late ticks are not made up for: the joints would move too fast
    }
    if (must_stop && must_stop()) {
      driver.stop();
    }
    static_cast<void>(driver.tick());
    next_us += driver.tick_us();
  }
  result.gait_ticks = driver.gait_ticks();
  result.max_difference_deg = driver.max_difference_deg();
  result.failure = driver.failure();
  return result;
}

}  // namespace proleg::host
