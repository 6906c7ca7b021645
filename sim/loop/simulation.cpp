#include "sim/loop/simulation.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "shared/kernel/servo_command.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {
namespace {

// The reader has checked everything that can be refused here, so a refusal is a fault of the program.
void expect_ok(Status status) {
  if (status != Status::ok) {
    throw std::logic_error("the kernel refused a checked scenario: " + std::string(describe(status)));
  }
}

Stepper choose_stepper(const Scenario& scenario) {
  constexpr std::size_t most_links_for_direct = 8;  // measured: above, the iterative stepper is faster
  if (scenario.solver == Solver::automatic) {
    return scenario.robot.links.size() <= most_links_for_direct ? Stepper::direct : Stepper::iterative;
  }
  return scenario.solver == Solver::direct ? Stepper::direct : Stepper::iterative;
}

}  // namespace

Simulation::Simulation(const Scenario& scenario)
    : scenario_(scenario),
      joint_memory_(scenario.robot.joints.size()),
      kernel_(joint_memory_),
      world_(scenario.robot, scenario.environment, scenario.step_s, choose_stepper(scenario)),
      steps_per_tick_(static_cast<std::uint32_t>(std::lround(scenario.kernel.tick_period_us * 1e-6 / scenario.step_s))),
      servo_schedule_(scenario.robot.servo.period_us, scenario.kernel.tick_period_us),
      start_(world_.center_of_mass()),
      latched_contacts_(scenario.robot.links.size()),
      setpoints_(scenario.robot.joints.size()),
      servo_commands_(scenario.robot.joints.size(), servo_center),
      link_poses_(scenario.robot.links.size()),
      joint_angles_(scenario.robot.joints.size()),
      link_contacts_(scenario.robot.links.size()) {
  expect_ok(kernel_.configure(scenario.kernel, 0));
  for (unsigned joint = 0; joint < scenario.joint_limits.size(); ++joint) {
    expect_ok(kernel_.set_limits(joint, scenario.joint_limits[joint].lower, scenario.joint_limits[joint].upper));
  }
  for (const Setting& setting : scenario.settings) {
    expect_ok(kernel_.set_parameter(setting.slot, setting.joint, setting.index, setting.value));
  }
  kernel_.reset();
  read_world();
}

double Simulation::time_s() const { return tick() * (scenario_.kernel.tick_period_us * 1e-6); }

const Change* Simulation::advance() {
  const Change* change = apply_changes();
  const Eigen::Vector3d center_before = world_.center_of_mass();
  latch_contacts();
  const std::uint64_t tick_start_us = std::uint64_t{tick()} * scenario_.kernel.tick_period_us;
  kernel_.advance();
  read_kernel();
  compute_servo_pulses();

  for (std::uint32_t step = 0; step < steps_per_tick_; ++step) {
    // Rounded down, which loses nothing: pulses start at whole microseconds.
    take_servo_pulses(tick_start_us + std::uint64_t{step} * scenario_.kernel.tick_period_us / steps_per_tick_);
    for (std::size_t joint = 0; joint < servo_commands_.size(); ++joint) {
      world_.set_joint_speed(joint, servo_speed(scenario_.robot.servo, scenario_.robot.joints[joint],
                                                servo_commands_[joint], world_.joint_angle(joint)));
    }
    world_.step();
    contact_sum_ += world_.contact_count();
  }
  take_servo_pulses(tick_start_us + scenario_.kernel.tick_period_us);
  read_world();
  require_crawling(center_before);
  return change;
}

void Simulation::require_crawling(const Eigen::Vector3d& center_before) const {
  constexpr double fastest = 100.0;  // m/s; a robot that crawls stays far below, one whose solver broke down does not
  constexpr double deepest = 1.0;    // m
  const Eigen::Vector3d center = world_.center_of_mass();
  const auto now = [&] {
    std::ostringstream text;
    text << time_s() << " s";
    return text.str();
  };
  if ((center - center_before).norm() > fastest * scenario_.kernel.tick_period_us * 1e-6) {
    throw PhysicsError("the simulation became unstable at " + now() + ": the robot moves faster than 100 m/s");
  }
  if (center.z() < world_.lowest_ground().value_or(start_.z()) - deepest) {
    throw PhysicsError("the robot fell off its environment: at " + now() +
                       " it is a metre below everything it could stand on");
  }
}

const Change* Simulation::apply_changes() {
  if (next_change_ >= scenario_.changes.size() || scenario_.changes[next_change_].tick != tick()) {
    return nullptr;
  }
  const Change& change = scenario_.changes[next_change_];
  const auto transaction = static_cast<std::uint16_t>(next_change_ + 1);
  bool staged = false;
  for (const Setting& setting : change.settings) {
    if (setting.internal) {
      expect_ok(kernel_.distort(setting.slot, setting.joint, setting.index, setting.value));
    } else {
      expect_ok(kernel_.stage(transaction, setting.slot, setting.joint, setting.index, setting.value));
      staged = true;
    }
  }
  if (staged) {
    expect_ok(kernel_.commit(transaction, tick()));
  }
  ++next_change_;
  return &change;
}

void Simulation::latch_contacts() {
  latched_contacts_ = link_contacts_;
  for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
    std::uint8_t contacts = latched_contacts_[joint + 1];
    if (joint == 0) {
      contacts = static_cast<std::uint8_t>(contacts | (latched_contacts_[0] << 2U));
    }
    kernel_.set_contacts(joint, contacts);
  }
}

void Simulation::read_kernel() {
  for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
    setpoints_[joint] = kernel_.setpoint(joint);
    setpoint_hash_.append(setpoints_[joint]);
  }
  internal_values_.clear();
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
      if (!kernel_.drives(slot, joint)) {
        continue;
      }
      const std::size_t count = scenario_.kernel.slots[slot].algorithm->declaration().internal_values.size();
      for (unsigned i = 0; i < count; ++i) {
        internal_values_.push_back(kernel_.internal_value(slot, joint, i));
      }
    }
  }
}

/// All pulses of the tick, before the first step of the physics: what they are does not depend on the steps.
void Simulation::compute_servo_pulses() {
  servo_pulses_.clear();
  taken_pulses_ = 0;
  const std::uint32_t k = tick() - 1;
  const std::uint64_t end = servo_schedule_.first_interval(std::uint64_t{k} + 1);
  for (std::uint64_t interval = servo_schedule_.first_interval(k); interval < end; ++interval) {
    const std::int32_t fraction = servo_schedule_.fraction(interval);
    for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
      const std::int32_t command =
          servo_command(interpolate(kernel_.previous_setpoint(joint), kernel_.setpoint(joint), fraction));
      servo_hash_.append(command);
      servo_pulses_.push_back({servo_schedule_.start_us(interval), joint, command});
    }
  }
}

/// A step of the physics moves the servos by the pulses whose intervals have started by its own start.
void Simulation::take_servo_pulses(std::uint64_t until_us) {
  for (; taken_pulses_ < servo_pulses_.size() && servo_pulses_[taken_pulses_].time_us <= until_us; ++taken_pulses_) {
    servo_commands_[servo_pulses_[taken_pulses_].joint] = servo_pulses_[taken_pulses_].command;
  }
}

void Simulation::read_world() {
  for (std::size_t joint = 0; joint < joint_angles_.size(); ++joint) {
    joint_angles_[joint] = world_.joint_angle(joint);
  }
  for (std::size_t link = 0; link < link_poses_.size(); ++link) {
    link_poses_[link] = world_.link_pose(link);
    link_contacts_[link] = world_.link_contacts(link);
  }
}

TickSample Simulation::sample() const {
  return {tick() - 1,    latched_contacts_, setpoints_,  internal_values_,
          servo_pulses_, servo_commands_,   link_poses_, joint_angles_};
}

double Simulation::displacement() const { return (world_.center_of_mass() - start_).head<2>().norm(); }

double Simulation::mean_contacts() const {
  const std::uint64_t steps = std::uint64_t{tick()} * steps_per_tick_;
  return steps == 0 ? 0.0 : static_cast<double>(contact_sum_) / static_cast<double>(steps);
}

}  // namespace proleg::sim
