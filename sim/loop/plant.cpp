#include "sim/loop/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "shared/kernel/servo_command.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/robot/servo.hpp"
#include "sim/robot/servo_current.hpp"

namespace proleg::sim {
namespace {

Stepper choose_stepper(const Scenario& scenario) {
  constexpr std::size_t most_links_for_direct = 8;  // measured: above, the iterative stepper is faster
  if (scenario.solver == Solver::automatic) {
    return scenario.robot.links.size() <= most_links_for_direct ? Stepper::direct : Stepper::iterative;
  }
  return scenario.solver == Solver::direct ? Stepper::direct : Stepper::iterative;
}

/// 90 degrees = 2^30, saturated.
std::int32_t joint_angle_in_steps(double radians) {
  constexpr double highest = std::numeric_limits<std::int32_t>::max();
  const double steps = std::round(radians / (std::numbers::pi / 2.0) * quarter_turn);
  return static_cast<std::int32_t>(std::clamp(steps, -highest, highest));
}

}  // namespace

Plant::Plant(const Scenario& scenario)
    : scenario_(scenario),
      world_(scenario.robot, scenario.environment, scenario.step_s, choose_stepper(scenario)),
      steps_per_tick_(static_cast<std::uint32_t>(std::lround(scenario.kernel.tick_period_us * 1e-6 / scenario.step_s))),
      start_(world_.center_of_mass()),
      center_before_(start_),
      limp_(scenario.robot.joints.size()),
      servo_commands_(scenario.robot.joints.size(), servo_center),
      last_step_(scenario.robot.joints.size()),
      link_poses_(scenario.robot.links.size()),
      joint_angles_(scenario.robot.joints.size()),
      link_contacts_(scenario.robot.links.size()) {
  read_world();
}

void Plant::set_command(std::size_t joint, std::int32_t command) {
  servo_commands_[joint] = command;
  if (limp_[joint]) {
    limp_[joint] = false;
    world_.set_joint_torque(joint, scenario_.robot.joints[joint].max_torque);
  }
}

void Plant::release(std::size_t joint) {
  if (!limp_[joint]) {
    limp_[joint] = true;
    world_.set_joint_torque(joint, 0.0);
  }
}

std::uint32_t Plant::step_start_us(std::uint32_t step) const {
  return static_cast<std::uint32_t>(std::uint64_t{step} * scenario_.kernel.tick_period_us / steps_per_tick_);
}

void Plant::step() {
  for (std::size_t joint = 0; joint < servo_commands_.size(); ++joint) {
    const double angle = world_.joint_angle(joint);
    const double speed =
        servo_speed(scenario_.robot.servo, scenario_.robot.joints[joint], servo_commands_[joint], angle);
    last_step_[joint] = {speed, angle};
    world_.set_joint_speed(joint, speed);
  }
  world_.step();
  contact_sum_ += world_.contact_count();
  ++steps_;
}

void Plant::finish_tick() {
  ++finished_ticks_;
  read_world();
  require_crawling();
  center_before_ = world_.center_of_mass();
}

void Plant::require_crawling() const {
  constexpr double fastest = 100.0;  // m/s; a robot that crawls stays far below, one whose solver broke down does not
  constexpr double deepest = 1.0;    // m
  const double tick_s = scenario_.kernel.tick_period_us * 1e-6;
  const Eigen::Vector3d center = world_.center_of_mass();
  const auto now = [&] {
    std::ostringstream text;
    text << finished_ticks_ * tick_s << " s";
    return text.str();
  };
  if ((center - center_before_).norm() > fastest * tick_s) {
    throw PhysicsError("the simulation became unstable at " + now() + ": the robot moves faster than 100 m/s");
  }
  if (center.z() < world_.lowest_ground().value_or(start_.z()) - deepest) {
    throw PhysicsError("the robot fell off its environment: at " + now() +
                       " it is a metre below everything it could stand on");
  }
}

void Plant::read_world() {
  for (std::size_t joint = 0; joint < joint_angles_.size(); ++joint) {
    joint_angles_[joint] = world_.joint_angle(joint);
  }
  for (std::size_t link = 0; link < link_poses_.size(); ++link) {
    link_poses_[link] = world_.link_pose(link);
    link_contacts_[link] = world_.link_contacts(link);
  }
}

firmware::ServoReadings Plant::servo_readings(std::size_t joint) const {
  constexpr std::int8_t chip_temperature_c = 25;
  constexpr ServoCurrent servo;
  const double angle = world_.joint_angle(joint);
  const Motion& motion = last_step_[joint];
  const double speed = steps_ == 0 ? 0.0 : (angle - motion.angle_before) / scenario_.step_s;
  const double current_ma =
      limp_[joint] ? servo.idle_ma
                   : servo_current_ma(servo, motion.commanded_speed, speed, scenario_.robot.joints[joint].max_speed);
  return {static_cast<std::uint16_t>(std::lround(current_ma)), joint_angle_in_steps(angle), chip_temperature_c};
}

double Plant::displacement() const { return (world_.center_of_mass() - start_).head<2>().norm(); }

double Plant::mean_contacts() const {
  return steps_ == 0 ? 0.0 : static_cast<double>(contact_sum_) / static_cast<double>(steps_);
}

}  // namespace proleg::sim
