#include "sim/loop/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "shared/kernel/servo_pulses.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/ode/ode_world.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {
namespace {

Stepper choose_stepper(const Scenario& scenario) {
  constexpr std::size_t max_links_for_direct = 8;  // measured: above, the iterative stepper is faster
  if (scenario.solver == Solver::automatic) {
    return scenario.robot.links.size() <= max_links_for_direct ? Stepper::automatic : Stepper::iterative;
  }
  return scenario.solver == Solver::direct ? Stepper::direct : Stepper::iterative;
}

std::unique_ptr<World> make_world(const Scenario& scenario) {
  switch (scenario.environment.engine) {
    case PhysicsEngine::ode:
      break;
    case PhysicsEngine::reduced:
      return reduced::make_reduced_world(scenario.robot, scenario.environment, scenario.step_s, scenario.path);
    case PhysicsEngine::mujoco:
      return mujoco::make_mujoco_world(scenario.robot, scenario.environment, scenario.step_s, scenario.path);
  }
  return make_ode_world(scenario.robot, scenario.environment, scenario.step_s, choose_stepper(scenario));
}

/// 90 degrees = 2^30, saturated.
std::int32_t joint_angle_in_steps(double radians) {
  constexpr double max_steps = std::numeric_limits<std::int32_t>::max();
  const double steps = std::round(radians / (std::numbers::pi / 2.0) * quarter_turn);
  return static_cast<std::int32_t>(std::clamp(steps, -max_steps, max_steps));
}

}  // namespace

Plant::Plant(const Scenario& scenario, std::unique_ptr<World> world)
    : scenario_(scenario),
      world_(world ? std::move(world) : make_world(scenario)),
      steps_per_tick_(static_cast<std::uint32_t>(std::lround(scenario.kernel.tick_period_us * 1e-6 / scenario.step_s))),
      start_(world_->center_of_mass()),
      start_energy_(world_->energy()),
      center_before_(start_),
      sensors_(scenario.robot.sensors, scenario.environment.gravity, scenario.step_s, scenario.kernel.tick_period_us,
               *world_),
      module_readings_(scenario, *world_),
      meter_(scenario.robot, scenario.environment, start_, scenario.step_s, scenario.kernel.tick_period_us * 1e-6),
      latency_steps_(
          static_cast<std::uint64_t>(std::llround(scenario.robot.servo.latency_us * 1e-6 / scenario.step_s))),
      servo_commands_(scenario.robot.joints.size(), servo_center),
      servos_(scenario.robot.joints.size(), Servo{servo_center}),
      contact_noise_(scenario.kernel.seed, random_stream::touch_sensors),
      link_poses_(scenario.robot.links.size()),
      object_poses_(scenario.environment.moving_objects.size()),
      joint_angles_(scenario.robot.joints.size()),
      motor_torques_(scenario.robot.joints.size()),
      servo_currents_(scenario.robot.joints.size()),
      contact_force_sums_(scenario.robot.links.size()),
      contact_forces_(scenario.robot.links.size()),
      joint_targets_(scenario.robot.joints.size()),
      speeds_(scenario.robot.joints.size()),
      angles_(scenario.robot.joints.size()),
      torques_(scenario.robot.joints.size()),
      link_contacts_(scenario.robot.links.size()) {
  for (std::size_t joint = 0; joint < servos_.size(); ++joint) {
    servos_[joint].angle = servos_[joint].angle_before = world_->joint_angle(joint);
  }
  read_world();
}

void Plant::set_command(std::size_t joint, std::int32_t command) {
  servo_commands_[joint] = command;
  if (latency_steps_ == 0) {
    act(joint, command);
  } else {
    delayed_pulses_.push_back({steps_ + latency_steps_, joint, command});
  }
}

void Plant::release(std::size_t joint) {
  if (latency_steps_ == 0) {
    go_limp(joint);
  } else {
    delayed_pulses_.push_back({steps_ + latency_steps_, joint, std::nullopt});
  }
}

void Plant::act(std::size_t joint, std::int32_t command) {
  Servo& servo = servos_[joint];
  if (servo.limp || servo.command != command) {
    disturb();
  }
  servo.command = command;
  if (servo.limp) {
    servo.limp = false;
    update_torque(joint);
  }
}

void Plant::go_limp(std::size_t joint) {
  if (!servos_[joint].limp) {
    servos_[joint].limp = true;
    update_torque(joint);
  }
}

void Plant::jam(std::size_t joint, std::uint32_t current_ma) {
  servos_[joint].jam_ma = current_ma;
  update_torque(joint);
}

void Plant::free(std::size_t joint) {
  servos_[joint].jam_ma.reset();
  update_torque(joint);
}

void Plant::move_robot(const Pose& motion) {
  world_->move_robot(motion);
  unmoved_ = unmoved_.value_or(Pose{}) * motion.inverse();
  center_before_ = world_->center_of_mass();
  disturb();
  read_world();
  sensors_.rest_at(link_poses_);
  module_readings_.rest_at(link_poses_);
}

void Plant::disturb() {
  disturbed_at_ = steps_;
  is_at_rest_ = false;
}

void Plant::step_world() {
  constexpr double still_after_s = 0.05;
  constexpr double slowest = 1e-4;           // m/s
  constexpr double slowest_rotation = 1e-3;  // rad/s
  if (is_at_rest_) {
    return;
  }
  try {
    world_->step();
  } catch (const PhysicsError& error) {
    throw PhysicsError(present_tick() + error.what());
  }
  if (!may_rest_) {
    return;
  }
  if (!world_->is_slower_than(slowest, slowest_rotation)) {
    disturb();
  }
  is_at_rest_ = static_cast<double>(steps_ - disturbed_at_) * scenario_.step_s >= still_after_s;
}

void Plant::update_torque(std::size_t joint) {
  disturb();
  constexpr double jam_strength = 20.0;  // times the servo's own torque: nothing in the robot turns the joint
  const Servo& servo = servos_[joint];
  const double own = scenario_.robot.joints[joint].max_torque;
  world_->set_joint_torque(joint, servo.jam_ma ? jam_strength * own : (servo.limp ? 0.0 : own));
}

void Plant::act_on_delayed_pulses() {
  for (; !delayed_pulses_.empty() && delayed_pulses_.front().step <= steps_; delayed_pulses_.pop_front()) {
    const DelayedPulse& pulse = delayed_pulses_.front();
    if (pulse.command) {
      act(pulse.joint, *pulse.command);
    } else {
      go_limp(pulse.joint);
    }
  }
}

std::uint32_t Plant::step_start_us(std::uint32_t step) const {
  return static_cast<std::uint32_t>(std::uint64_t{step} * scenario_.kernel.tick_period_us / steps_per_tick_);
}

void Plant::begin_step() {
  if (latency_steps_ > 0) {
    act_on_delayed_pulses();
  }
  for (std::size_t joint = 0; joint < servos_.size(); ++joint) {
    Servo& servo = servos_[joint];
    servo.commanded_speed =
        servo_speed(scenario_.robot.servo, scenario_.robot.joints[joint], servo.command, servo.angle);
    servo.angle_before = servo.angle;
    speeds_[joint] = servo.jam_ma ? 0.0 : servo.commanded_speed;
  }
  world_->set_joint_speeds(speeds_);
}

void Plant::finish_step() {
  step_world();
  world_->read_joints(angles_, torques_);
  for (std::size_t joint = 0; joint < servos_.size(); ++joint) {
    Servo& servo = servos_[joint];
    servo.angle = angles_[joint];
    const double torque = torques_[joint];
    servo.torque_sum += torque;
    double current =
        meter_.add_joint_step(joint, {torque, servo.commanded_speed, servo.angle_before, servo.angle, servo.limp});
    if (servo.jam_ma && !servo.limp) {
      current = *servo.jam_ma;
    }
    servo.current_sum += current;
    servo.drawn += current;
  }
  sensors_.add_step(*world_);
  module_readings_.add_step(*world_);
  world_->add_contact_forces(contact_force_sums_);
  const ContactSliding sliding = world_->contact_sliding();
  meter_.add_contacts(sliding.normal_force, sliding.force_times_speed, sliding.friction_power);
  contact_sum_ += world_->contact_count();
  ++steps_;
}

void Plant::finish_tick(std::span<const std::int32_t> setpoints) {
  read_world();
  setpoints_.clear();
  for (const std::int32_t setpoint : setpoints) {
    setpoints_.push_back(setpoint * (std::numbers::pi / 2.0 / quarter_turn));
  }
  for (std::size_t joint = 0; joint < servos_.size(); ++joint) {
    motor_torques_[joint] = std::exchange(servos_[joint].torque_sum, 0.0) / steps_per_tick_;
    servo_currents_[joint] = std::exchange(servos_[joint].current_sum, 0.0) / steps_per_tick_;
  }
  for (std::size_t link = 0; link < contact_force_sums_.size(); ++link) {
    contact_forces_[link] = std::exchange(contact_force_sums_[link], 0.0) / steps_per_tick_;
  }
  const Eigen::Vector3d center = world_->center_of_mass();
  require_crawling(center);
  ++finished_ticks_;
  center_before_ = center;
  if (unmoved_) {
    unmoved_link_poses_.clear();
    for (const Pose& pose : link_poses_) {
      unmoved_link_poses_.push_back(*unmoved_ * pose);
    }
    meter_.add_tick({*unmoved_ * center, unmoved_link_poses_, joint_angles_, joint_targets_, setpoints_, link_contacts_,
                     motor_torques_});
  } else {
    meter_.add_tick({center, link_poses_, joint_angles_, joint_targets_, setpoints_, link_contacts_, motor_torques_});
  }
  sensors_.finish_tick(*world_, link_poses_, servo_currents_);
  module_readings_.finish_tick(*world_, link_poses_);
  sensors_.replace_inputs(link_contacts_);
  add_contact_noise();
}

std::string Plant::present_tick() const {
  std::ostringstream text;
  text << "tick " << finished_ticks_ << " (" << finished_ticks_ * (scenario_.kernel.tick_period_us * 1e-6) << " s): ";
  return text.str();
}

void Plant::require_crawling(const Eigen::Vector3d& center) const {
  constexpr double max_speed = 100.0;  // m/s; a robot that crawls is far slower, one whose solver failed is not
  constexpr double max_fall = 1.0;     // m
  const double tick_s = scenario_.kernel.tick_period_us * 1e-6;
  if ((center - center_before_).norm() > max_speed * tick_s) {
    throw PhysicsError(present_tick() + "the simulation became unstable: the robot moves faster than 100 m/s");
  }
  if (center.z() < world_->lowest_ground().value_or(start_.z()) - max_fall) {
    throw PhysicsError(present_tick() +
                       "the robot fell off its environment: it is a metre below everything it could stand on");
  }
}

void Plant::read_world() {
  for (std::size_t joint = 0; joint < joint_angles_.size(); ++joint) {
    joint_angles_[joint] = servos_[joint].angle;
    joint_targets_[joint] = servo_target(servos_[joint].command);
  }
  world_->read_links(link_poses_);
  world_->read_objects(object_poses_);
  for (std::size_t link = 0; link < link_contacts_.size(); ++link) {
    link_contacts_[link] = world_->link_contacts(link);
  }
}

void Plant::add_contact_noise() {
  if (scenario_.contact_noise <= 0.0) {
    return;
  }
  const auto threshold = static_cast<std::uint64_t>(std::llround(std::ldexp(scenario_.contact_noise, 32)));
  for (std::uint8_t& contacts : link_contacts_) {
    for (const unsigned sensor : {1U, 2U}) {
      if (contact_noise_.next() < threshold) {
        contacts = static_cast<std::uint8_t>(contacts ^ sensor);
      }
    }
  }
}

void Plant::add_to(TickSample& sample) const {
  sample.servo_commands = servo_commands_;
  sample.link_poses = link_poses_;
  sample.joint_angles = joint_angles_;
  sample.motor_torques = motor_torques_;
  sample.servo_currents = servo_currents_;
  sample.contact_forces = contact_forces_;
  sample.object_poses = object_poses_;
  sample.sensor_values = sensors_.values();
  sample.measured_sensors = sensors_.measured();
  sample.has_world = true;
}

ServoReadings Plant::servo_readings(std::size_t joint) const {
  constexpr std::int8_t chip_temperature_c = 25;
  constexpr ServoCurrent model;
  const Servo& servo = servos_[joint];
  const double speed = (servo.angle - servo.angle_before) / scenario_.step_s;
  const double moving_ma =
      servo_current_ma(model, servo.commanded_speed, speed, scenario_.robot.joints[joint].max_speed);
  const double current_ma = servo.limp ? model.idle_ma : servo.jam_ma.value_or(moving_ma);
  return {static_cast<std::uint16_t>(std::lround(current_ma)), joint_angle_in_steps(servo.angle), chip_temperature_c};
}

double Plant::displacement() const {
  const Eigen::Vector3d center = world_->center_of_mass();
  return ((unmoved_ ? *unmoved_ * center : center) - start_).head<2>().norm();
}

Plant::EnergyBalance Plant::energy_balance() const {
  EnergyBalance balance{meter_.motor_work(), meter_.friction_work(), world_->energy() - start_energy_, 0.0};
  balance.unexplained = balance.stored - balance.motors + balance.friction;
  return balance;
}

double Plant::mean_contacts() const {
  return steps_ == 0 ? 0.0 : static_cast<double>(contact_sum_) / static_cast<double>(steps_);
}

}  // namespace proleg::sim
