#include "sim/measure/gait_meter.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "sim/measure/crawling_models.hpp"

namespace proleg::sim {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double min_distance = 1e-3;  // m; below, costs of transport are noise
/// A direction whose horizontal part is shorter counts as vertical.
constexpr double vertical = 1e-6;

/// The ends of a link, in the robot's frame: its joints; at the end of the robot a point beyond the centre of mass.
struct LinkEnds {
  Eigen::Vector3d rear;
  Eigen::Vector3d front;
};

LinkEnds link_ends(const RobotModel& robot, std::size_t link) {
  const Eigen::Vector3d center = robot.links[link].pose * robot.links[link].mass.center;
  LinkEnds ends{center, center};
  if (link < robot.joints.size()) {
    ends.rear = robot.joints[link].anchor;
  }
  if (link > 0) {
    ends.front = robot.joints[link - 1].anchor;
  }
  // An end link reaches as far beyond its centre of mass as its joint is from it.
  if (link == 0) {
    ends.front = 2.0 * center - ends.rear;
  }
  if (link == robot.joints.size()) {
    ends.rear = 2.0 * center - ends.front;
  }
  return ends;
}

std::vector<double> parallel_axis_signs(const RobotModel& robot) {
  constexpr double parallel = 0.99;  // cosine of 8 degrees
  std::vector<double> signs;
  for (const Joint& joint : robot.joints) {
    const double cosine = joint.axis.normalized().dot(robot.joints.front().axis.normalized());
    if (std::abs(cosine) < parallel) {
      return {};
    }
    signs.push_back(cosine > 0.0 ? 1.0 : -1.0);
  }
  return signs;
}

}  // namespace

GaitMeter::GaitMeter(const RobotModel& robot, const EnvironmentModel& environment, const Eigen::Vector3d& start,
                     double step_s, double tick_s)
    : steps_per_s_(1.0 / step_s),
      step_s_(step_s),
      tick_s_(tick_s),
      gravity_(environment.gravity.norm()),
      axis_signs_(parallel_axis_signs(robot)),
      start_(start),
      center_(start),
      center_before_(start) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const LinkEnds ends = link_ends(robot, i);
    mass_ += link.mass.mass;
    body_length_ += (ends.front - ends.rear).norm();
    const Eigen::Vector3d quarter = link.pose.orientation.conjugate() * ((ends.front - ends.rear) / 4.0);
    sensors_.push_back({link.mass.center - quarter, link.mass.center + quarter});
    link_centers_.push_back(link.mass.center);
  }
  for (const Joint& joint : robot.joints) {
    joints_.push_back({1.0 / joint.max_speed});
  }
  const LinkEnds head = link_ends(robot, 0);
  const Eigen::Vector2d forward = (environment.robot_pose.orientation * (head.front - head.rear)).head<2>();
  forward_ = forward.norm() > vertical * body_length_ ? forward.normalized().eval()
                                                      : Eigen::Vector2d::Constant(undefined).eval();
}

void GaitMeter::add_tick(const Tick& tick) {
  if (ticks_ > 0) {
    squared_second_differences_ += (tick.center_of_mass - 2.0 * center_ + center_before_).squaredNorm();
  }
  center_before_ = center_;
  center_ = tick.center_of_mass;
  add_stability(tick);
  if (angles_.size() >= 2 * history_ticks * joints_.size()) {
    drop_oldest_ticks();
  }
  angles_.insert(angles_.end(), tick.joint_angles.begin(), tick.joint_angles.end());
  targets_.insert(targets_.end(), tick.joint_targets.begin(), tick.joint_targets.end());
  contacts_.insert(contacts_.end(), tick.link_contacts.begin(), tick.link_contacts.end());
  ++ticks_;
}

void GaitMeter::add_stability(const Tick& tick) {
  const Eigen::Vector3d head = tick.link_poses.front() * link_centers_.front();
  const Eigen::Vector3d tail = tick.link_poses.back() * link_centers_.back();
  const Eigen::Vector2d span = (head - tail).head<2>();
  const double length = span.norm();
  if (length <= vertical * body_length_) {
    return;
  }
  const Eigen::Vector2d axis = span / length;
  double rearmost = std::numeric_limits<double>::infinity();
  double foremost = -rearmost;
  const auto support = [&](const Pose& pose, const Eigen::Vector3d& sensor) {
    const double position = axis.dot((pose * sensor - tick.center_of_mass).head<2>());
    rearmost = std::min(rearmost, position);
    foremost = std::max(foremost, position);
  };
  for (std::size_t link = 0; link < tick.link_contacts.size(); ++link) {
    if ((tick.link_contacts[link] & 1U) != 0) {
      support(tick.link_poses[link], sensors_[link].rear);
    }
    if ((tick.link_contacts[link] & 2U) != 0) {
      support(tick.link_poses[link], sensors_[link].front);
    }
  }
  if (rearmost <= foremost) {
    margin_sum_ += std::min(-rearmost, foremost);
    ++supported_ticks_;
  }
}

void GaitMeter::drop_oldest_ticks() {
  const auto joint_values = static_cast<std::ptrdiff_t>(history_ticks * joints_.size());
  angles_.erase(angles_.begin(), angles_.begin() + joint_values);
  targets_.erase(targets_.begin(), targets_.begin() + joint_values);
  contacts_.erase(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(history_ticks * sensors_.size()));
}

std::optional<Stride> GaitMeter::stride() const { return find_stride({targets_, joints_.size()}, tick_s_); }

double GaitMeter::speed_along(double heading_deg) const {
  const double heading = heading_deg * (std::numbers::pi / 180.0);
  const Eigen::Vector2d left(-forward_.y(), forward_.x());
  const Eigen::Vector2d direction = std::cos(heading) * forward_ + std::sin(heading) * left;
  return (center_ - start_).head<2>().dot(direction) / (static_cast<double>(ticks_) * tick_s_);
}

/// Thesis, equation 3.2, for the wave of the joints that swing by at least a tenth of the maximum amplitude. Not a
/// number if there is no such wave.
double GaitMeter::predicted_step(const Stride& stride) const {
  if (axis_signs_.empty()) {
    return undefined;
  }
  constexpr double moving = 0.1;
  constexpr double agreeing = 0.5;
  constexpr double first_zero_of_j0 = 2.404825557695773;
  const std::vector<Oscillation> swings = find_oscillations({angles_, joints_.size()}, stride);
  const double max_amplitude = std::ranges::max(swings, {}, &Oscillation::amplitude).amplitude;
  const auto moves = [&](std::size_t joint) { return swings[joint].amplitude >= moving * max_amplitude; };
  double amplitude_sum = 0.0;
  double moving_joints = 0.0;
  std::complex<double> difference_sum;
  double differences = 0.0;
  for (std::size_t joint = 0; joint < swings.size(); ++joint) {
    if (!moves(joint)) {
      continue;
    }
    amplitude_sum += swings[joint].amplitude;
    moving_joints += 1.0;
    if (joint > 0 && moves(joint - 1)) {
      const double sign = axis_signs_[joint] * axis_signs_[joint - 1];
      difference_sum += sign * std::polar(1.0, swings[joint].phase - swings[joint - 1].phase);
      differences += 1.0;
    }
  }
  // Differences in all directions have no mean.
  if (differences == 0.0 || std::abs(difference_sum) < agreeing * differences) {
    return undefined;
  }
  const double phase_difference = std::arg(difference_sum);
  const double alpha = winding_angle(amplitude_sum / moving_joints, phase_difference);
  // From this angle on the curve turns back on itself, and the wave has no length.
  if (!(alpha < first_zero_of_j0)) {
    return undefined;
  }
  return predicted_step_length(body_length_, wave_count(phase_difference, static_cast<double>(joints_.size())), alpha);
}

std::vector<double> GaitMeter::duty_factors(const std::optional<Stride>& stride) const {
  const std::size_t links = sensors_.size();
  const std::size_t first = stride ? stride->first_tick : 0;
  const std::size_t end = stride ? stride->end_tick : contacts_.size() / links;
  std::vector<double> factors(links);
  for (std::size_t tick = first; tick < end; ++tick) {
    for (std::size_t link = 0; link < links; ++link) {
      factors[link] += contacts_[tick * links + link] != 0 ? 1.0 : 0.0;
    }
  }
  for (double& factor : factors) {
    factor /= static_cast<double>(end - first);  // not a number before the first tick
  }
  return factors;
}

std::vector<double> GaitMeter::link_duty_factors() const { return duty_factors(stride()); }

MeasureValues GaitMeter::values(double heading_deg) const {
  MeasureValues values;
  if (ticks_ == 0) {
    return values;
  }
  const double time_s = static_cast<double>(ticks_) * tick_s_;
  const double distance = (center_ - start_).head<2>().norm();
  const double mechanical = mechanical_power_sum_ * step_s_;
  const double electrical = current_sum_ma_ * 1e-3 * servo_supply_v * step_s_;
  values[Measure::distance] = distance;
  values[Measure::speed] = speed_along(heading_deg);
  values[Measure::mechanical_energy] = mechanical;
  values[Measure::electrical_energy] = electrical;
  if (distance >= min_distance) {
    values[Measure::cost_of_transport] = mechanical / (mass_ * distance);
    values[Measure::electrical_cost_of_transport] = electrical / (mass_ * distance);
    if (gravity_ > 0.0) {
      values[Measure::specific_resistance] = mechanical / (mass_ * distance * gravity_);
    }
  }
  if (ticks_ > 1) {
    const double mean_square = squared_second_differences_ / static_cast<double>(ticks_ - 1);
    values[Measure::smoothness] = std::sqrt(mean_square) / (tick_s_ * tick_s_);
  }
  if (supported_ticks_ > 0) {
    values[Measure::stability_margin] = margin_sum_ / static_cast<double>(supported_ticks_);
  }
  values[Measure::height] = center_.z() - start_.z();

  const std::optional<Stride> stride = this->stride();
  double duty_sum = 0.0;
  for (const double factor : duty_factors(stride)) {
    duty_sum += factor;
  }
  values[Measure::duty_factor] = duty_sum / static_cast<double>(sensors_.size());
  if (stride) {
    const double length = distance / (time_s * stride->frequency);
    values[Measure::stride_frequency] = stride->frequency;
    values[Measure::stride_length] = length;
    values[Measure::slip] = 1.0 - length / predicted_step(*stride);
    if (gravity_ > 0.0) {
      // v^2 / (g * length), v = length * frequency
      values[Measure::froude_number] = length * stride->frequency * stride->frequency / gravity_;
    }
  }
  return values;
}

}  // namespace proleg::sim
