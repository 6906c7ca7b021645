#include "sim/loop/simulation.hpp"

#include <cmath>
#include <stdexcept>

#include "shared/kernel/servo_command.hpp"
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
      start_(world_.center_of_mass()),
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
  latch_contacts();
  const std::uint64_t tick_start_us = std::uint64_t{tick()} * scenario_.kernel.tick_period_us;
  kernel_.advance();
  for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
    setpoint_hash_.append(kernel_.setpoint(joint));
  }

  for (std::uint32_t step = 0; step < steps_per_tick_; ++step) {
    const std::uint32_t elapsed_us = step * scenario_.kernel.tick_period_us / steps_per_tick_;
    if (tick_start_us + elapsed_us >= next_servo_us_) {
      take_servo_commands(elapsed_us);
      next_servo_us_ += scenario_.robot.servo.period_us;
    }
    for (std::size_t joint = 0; joint < servo_commands_.size(); ++joint) {
      world_.set_joint_speed(joint, servo_speed(scenario_.robot.servo, scenario_.robot.joints[joint],
                                                servo_commands_[joint], world_.joint_angle(joint)));
    }
    world_.step();
    contact_sum_ += world_.contact_count();
  }
  read_world();
  return change;
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
  for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
    std::uint8_t contacts = link_contacts_[joint + 1];
    if (joint == 0) {
      contacts = static_cast<std::uint8_t>(contacts | (link_contacts_[0] << 2U));
    }
    kernel_.set_contacts(joint, contacts);
  }
}

void Simulation::take_servo_commands(std::uint32_t elapsed_us) {
  const std::int32_t fraction =
      sample_fraction(elapsed_us, scenario_.robot.servo.period_us, scenario_.kernel.tick_period_us);
  for (unsigned joint = 0; joint < kernel_.local_joint_count(); ++joint) {
    servo_commands_[joint] =
        servo_command(interpolate(kernel_.previous_setpoint(joint), kernel_.setpoint(joint), fraction));
    servo_hash_.append(servo_commands_[joint]);
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

double Simulation::displacement() const { return (world_.center_of_mass() - start_).head<2>().norm(); }

double Simulation::mean_contacts() const {
  const std::uint64_t steps = std::uint64_t{tick()} * steps_per_tick_;
  return steps == 0 ? 0.0 : static_cast<double>(contact_sum_) / static_cast<double>(steps);
}

}  // namespace proleg::sim
