#include "sim/measure/gait_meter.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/measure/stride.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double min_distance = 1e-3;  // m; for shorter distances costs of transport are noise
/// A direction whose horizontal part is shorter counts as vertical.
constexpr double vertical = 1e-6;

/// A number without the last bits of the system's arctangent, sine or Bessel function: they depend on its version and
/// on the processor, and a measure is the same on every computer.
double without_last_bits(double value) { return std::round(std::ldexp(value, 24)) * 0x1p-24; }

}  // namespace

BodyEnergy::BodyEnergy(const RobotModel& robot, const Pose& start, double gravity, double tick_s)
    : weight_per_mass_(gravity), ticks_per_s_(1.0 / tick_s) {
  for (const Link& link : robot.links) {
    const Pose pose = start * link.pose;
    bodies_.push_back({link.mass, pose * link.mass.center, pose.orientation});
    start_moment_ += link.mass.mass * bodies_.back().center.z();
  }
}

void BodyEnergy::add_tick(std::span<const Pose> link_poses, std::span<const double> joint_angles,
                          std::span<const double> joint_targets, std::span<const double> motor_torques) {
  double moment = 0.0;
  double kinetic = 0.0;
  for (std::size_t link = 0; link < bodies_.size(); ++link) {
    Body& body = bodies_[link];
    const Eigen::Vector3d center = link_poses[link] * body.mass.center;
    const Eigen::Vector3d velocity = (center - body.center) * ticks_per_s_;
    // The vector of a quaternion has the length of the sine of half the angle; for the turn of a tick this is half the
    // angle itself. The vector is in the frame of the link, as is the inertia.
    const Eigen::Quaterniond turn = body.orientation.conjugate() * link_poses[link].orientation;
    const Eigen::Vector3d rotation = (turn.w() < 0.0 ? -2.0 : 2.0) * ticks_per_s_ * turn.vec();
    kinetic += 0.5 * (body.mass.mass * velocity.squaredNorm() + rotation.dot(body.mass.inertia * rotation));
    moment += body.mass.mass * center.z();
    body.center = center;
    body.orientation = link_poses[link].orientation;
  }
  kinetic_sum_ += kinetic;
  potential_sum_ += weight_per_mass_ * (moment - start_moment_);
  for (std::size_t joint = 0; joint < motor_torques.size(); ++joint) {
    elastic_sum_ += 0.5 * std::abs(motor_torques[joint] * (joint_targets[joint] - joint_angles[joint]));
  }
  ++ticks_;
}

GaitMeter::GaitMeter(const RobotModel& robot, const EnvironmentModel& environment, const Eigen::Vector3d& start,
                     double step_s, double tick_s)
    : steps_per_s_(1.0 / step_s),
      step_s_(step_s),
      tick_s_(tick_s),
      gravity_(environment.gravity.norm()),
      energy_(robot, environment.robot_pose, environment.gravity.norm(), tick_s),
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
  bends_vertically_ = !robot.joints.empty() && direction_of(robot.joints.front()) == JointDirection::pitch;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    constexpr double cosine_of_45_degrees = 0.7071;
    if (std::abs(joint.axis.dot(robot.joints.front().axis)) > cosine_of_45_degrees) {
      planar_joints_.push_back(i);
    }
    joints_.push_back({1.0 / joint.max_speed});
    tracking_.emplace_back(joint.max_speed, joint.max_torque);
  }
  const LinkEnds head = link_ends(robot, 0);
  const Eigen::Vector2d forward = (environment.robot_pose.orientation * (head.front - head.rear)).head<2>();
  span_ = forward;
  forward_ = forward.norm() > vertical * body_length_ ? forward.normalized().eval()
                                                      : Eigen::Vector2d::Constant(undefined).eval();
}

void GaitMeter::add_tick(const Tick& tick) {
  if (ticks_ > 0) {
    const double squared = (tick.center_of_mass - 2.0 * center_ + center_before_).squaredNorm();
    squared_second_differences_ += squared;
    largest_squared_second_difference_ = std::fmax(largest_squared_second_difference_, squared);
  }
  energy_.add_tick(tick.link_poses, tick.joint_angles, tick.joint_targets, tick.motor_torques);
  center_before_ = center_;
  center_ = tick.center_of_mass;
  const Eigen::Vector3d head = tick.link_poses.front() * link_centers_.front();
  const Eigen::Vector3d tail = tick.link_poses.back() * link_centers_.back();
  const Eigen::Vector2d span = (head - tail).head<2>();
  if (span.norm() > vertical * body_length_) {
    add_stability(tick, span);
    add_turn(span);
  }
  add_tracking(tick);
  if (targets_.size() >= 2 * history_ticks * joints_.size()) {
    drop_oldest_ticks();
  }
  targets_.insert(targets_.end(), tick.joint_targets.begin(), tick.joint_targets.end());
  contacts_.insert(contacts_.end(), tick.link_contacts.begin(), tick.link_contacts.end());
  places_.emplace_back(center_.head<2>());
  ++ticks_;
  has_settled_ = static_cast<double>(ticks_) * tick_s_ >= settling_s;
}

void GaitMeter::add_turn(const Eigen::Vector2d& span) {
  // A body that turns by half a turn within a tick has no direction of turning.
  turn_ += std::atan2(span_.x() * span.y() - span_.y() * span.x(), span_.dot(span));
  span_ = span;
}

void GaitMeter::add_tracking(const Tick& tick) {
  for (std::size_t joint = 0; joint < tick.setpoints.size(); ++joint) {
    if (!joints_[joint].limp && has_settled_) {
      tracking_[joint].add_tick(tick.setpoints[joint] - tick.joint_angles[joint]);
    }
  }
}

/// span: from tail to head, seen from above.
void GaitMeter::add_stability(const Tick& tick, const Eigen::Vector2d& span) {
  const Eigen::Vector2d axis = span.normalized();
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
  targets_.erase(targets_.begin(), targets_.begin() + joint_values);
  places_.erase(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(history_ticks));
  contacts_.erase(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(history_ticks * sensors_.size()));
}

std::optional<Stride> GaitMeter::stride() const { return find_stride({targets_, joints_.size()}, tick_s_); }

std::optional<std::pair<double, double>> GaitMeter::recent_strides(std::size_t ticks) const {
  constexpr std::size_t least_strides = 2;
  constexpr double least_s = 1.0;
  const SignalTable targets{std::span(targets_).last(ticks * joints_.size()), joints_.size()};
  const std::optional<Stride> stride = find_stride(targets, tick_s_);
  if (!stride || stride->bounds.size() <= least_strides) {
    return std::nullopt;
  }
  const std::vector<double>& bounds = stride->bounds;
  std::size_t start = bounds.size() - 1 - least_strides;
  while (start > 0 && (bounds.back() - bounds[start]) * tick_s_ < least_s) {
    --start;
  }
  const double last_stride = bounds.back() - bounds[bounds.size() - 2];
  if (static_cast<double>(ticks) - bounds.back() > 1.25 * last_stride) {
    return std::nullopt;  // the next one is overdue: they are those of another gait, before a change
  }
  const auto first = static_cast<double>(places_.size() - ticks);
  return std::pair{first + bounds[start], first + bounds.back()};
}

std::optional<double> GaitMeter::recent_speed() const {
  const auto ticks_in = [&](double seconds) { return static_cast<std::size_t>(std::lround(seconds / tick_s_)); };
  const std::size_t without_strides = ticks_in(2.0);
  if (places_.size() <= without_strides) {
    return std::nullopt;
  }
  std::size_t last = places_.size() - 1;
  std::size_t first = last - without_strides;
  // The shortest history comes first: after a change it is the first one that has only the new gait.
  for (const double seconds : {2.5, 5.0, 10.0, 20.0}) {
    if (const auto strides = recent_strides(std::min(ticks_in(seconds), places_.size()))) {
      first = static_cast<std::size_t>(std::lround(strides->first));
      last = std::min(static_cast<std::size_t>(std::lround(strides->second)), last);
      break;
    }
  }
  return (places_[last] - places_[first]).norm() / (static_cast<double>(last - first) * tick_s_);
}

double GaitMeter::speed_along(double heading_deg) const {
  const double heading = heading_deg * (std::numbers::pi / 180.0);
  const Eigen::Vector2d left(-forward_.y(), forward_.x());
  const Eigen::Vector2d direction = std::cos(heading) * forward_ + std::sin(heading) * left;
  return (center_ - start_).head<2>().dot(direction) / (static_cast<double>(ticks_) * tick_s_);
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

void GaitMeter::add_servo_measures(MeasureValues& values) const {
  constexpr double degrees = 180.0 / std::numbers::pi;
  double squares = 0.0;
  double ticks = 0.0;
  double largest = 0.0;
  double at_speed_limit = 0.0;
  double at_torque_limit = 0.0;
  double steps = 0.0;
  for (const ServoTracking& servo : tracking_) {
    squares += servo.squared_errors();
    ticks += static_cast<double>(servo.ticks());
    largest = std::fmax(largest, servo.max_error());
    if (const auto own_steps = static_cast<double>(servo.steps()); own_steps > 0.0) {
      at_speed_limit += servo.at_speed_limit() * own_steps;
      at_torque_limit += servo.at_torque_limit() * own_steps;
      steps += own_steps;
    }
  }
  if (ticks > 0.0) {
    values[Measure::tracking_error] = std::sqrt(squares / ticks) * degrees;
    values[Measure::max_tracking_error] = largest * degrees;
  }
  if (steps > 0.0) {
    values[Measure::at_speed_limit] = at_speed_limit / steps;
    values[Measure::at_torque_limit] = at_torque_limit / steps;
  }
}

void GaitMeter::add_wave_measures(MeasureValues& values, const Stride& stride) const {
  constexpr double degree = std::numbers::pi / 180.0;
  const std::optional<BodyWave> wave = find_body_wave({targets_, joints_.size()}, planar_joints_, stride, tick_s_);
  if (!wave) {
    return;
  }
  const double phase_difference = without_last_bits(wave->phase_difference / degree) * degree;
  const double amplitude = without_last_bits(wave->amplitude / degree) * degree;
  const double waves = wave_count(phase_difference, static_cast<double>(wave->joints));
  values[Measure::wave_count] = waves;
  // The equation is for a wave in the vertical plane, of which the body has at least a half, and whose links never
  // head backwards.
  constexpr double least_waves = 0.5;
  if (!bends_vertically_ || waves < least_waves) {
    return;
  }
  if (const double winding = winding_angle(amplitude, phase_difference); winding <= std::numbers::pi / 2.0) {
    const double step = predicted_step_length(body_length_, waves, winding);
    values[Measure::predicted_distance] =
        without_last_bits(step * stride.frequency * static_cast<double>(ticks_) * tick_s_);
  }
}

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
  values[Measure::sideways_speed] = speed_along(90.0);
  constexpr double degrees = 180.0 / std::numbers::pi;
  values[Measure::yaw_rate] = without_last_bits(turn_ * degrees / time_s);
  values[Measure::mechanical_energy] = mechanical;
  values[Measure::electrical_energy] = electrical;
  if (joint_steps_ > 0) {
    values[Measure::mean_current] = current_sum_ma_ / static_cast<double>(joint_steps_);
  }
  if (distance >= min_distance) {
    values[Measure::heading] = without_last_bits(std::atan2(speed_along(90.0), speed_along(0.0)) * degrees);
    if (normal_force_sum_ > 0.0) {
      values[Measure::slip] = sliding_sum_ / normal_force_sum_ * time_s / distance;
    }
    values[Measure::cost_of_transport] = mechanical / (mass_ * distance);
    values[Measure::electrical_cost_of_transport] = electrical / (mass_ * distance);
    if (gravity_ > 0.0) {
      values[Measure::specific_resistance] = mechanical / (mass_ * distance * gravity_);
    }
  }
  if (ticks_ > 1) {
    const double mean_square = squared_second_differences_ / static_cast<double>(ticks_ - 1);
    values[Measure::smoothness] = std::sqrt(mean_square) / (tick_s_ * tick_s_);
    values[Measure::largest_acceleration] = std::sqrt(largest_squared_second_difference_) / (tick_s_ * tick_s_);
  }
  if (supported_ticks_ > 0) {
    values[Measure::stability_margin] = margin_sum_ / static_cast<double>(supported_ticks_);
  }
  values[Measure::height] = center_.z() - start_.z();
  values[Measure::potential_energy] = energy_.mean_potential();
  values[Measure::kinetic_energy] = energy_.mean_kinetic();
  values[Measure::elastic_energy] = energy_.mean_elastic();
  add_servo_measures(values);

  const std::optional<Stride> stride = this->stride();
  double duty_sum = 0.0;
  for (const double factor : duty_factors(stride)) {
    duty_sum += factor;
  }
  values[Measure::duty_factor] = duty_sum / static_cast<double>(sensors_.size());
  values[Measure::lifted_links] = static_cast<double>(sensors_.size()) - duty_sum;
  if (stride) {
    add_wave_measures(values, *stride);
    const double length = distance / (time_s * stride->frequency);
    values[Measure::stride_frequency] = stride->frequency;
    values[Measure::stride_length] = length;
    if (gravity_ > 0.0) {
      // The Froude number is v^2 / (g * length), with v = length * frequency.
      values[Measure::froude_number] = length * stride->frequency * stride->frequency / gravity_;
    }
  }
  return values;
}

}  // namespace proleg::sim
