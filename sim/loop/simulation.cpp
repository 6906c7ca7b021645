#include "sim/loop/simulation.hpp"

#include <utility>

#include "sim/loop/robot_placement.hpp"
#include "sim/record/internal_values.hpp"

namespace proleg::sim {

Simulation::Simulation(const Scenario& scenario, const Losses* losses) : Simulation(scenario, losses, nullptr) {}

Simulation::Simulation(const Scenario& scenario, std::unique_ptr<World> world)
    : Simulation(scenario, nullptr, std::move(world)) {}

Simulation::Simulation(const Scenario& scenario, const Losses* losses, std::unique_ptr<World> world)
    : scenario_(scenario),
      chain_(scenario.kernel, scenario.joint_limits, scenario.settings),
      plant_(scenario, std::move(world)),
      touch_(scenario.robot.joints.size()),
      pulse_source_({scenario.robot.servo.period_us, scenario.kernel.tick_period_us}, scenario.joint_limits,
                    scenario.robot.servo.command_speed),
      pulse_player_(plant_, pulse_source_.schedule()),
      latched_contacts_(scenario.robot.links.size()),
      needs_readings_(chain_.needs_readings()) {
  chain_.set_losses(losses);
  if (needs_readings_) {
    read_modules();
  }
}

void Simulation::read_modules() {
  readings_.clear();
  for (unsigned joint = 0; joint < chain_.joint_count(); ++joint) {
    readings_.push_back(plant_.joint_readings(joint));
  }
}

double Simulation::time_s() const { return tick() * (scenario_.kernel.tick_period_us * 1e-6); }

void Simulation::apply_moves() {
  for (; next_move_ < scenario_.moves.size() && scenario_.moves[next_move_].tick == tick(); ++next_move_) {
    plant_.move_robot(placement(scenario_.moves[next_move_], plant_.link_poses(), scenario_));
  }
}

const Change* Simulation::advance() {
  const Change* const change = begin_tick();
  for (std::uint32_t step = 0; step < plant_.steps_per_tick(); ++step) {
    begin_step(step);
    finish_step();
  }
  end_tick();
  return change;
}

const Change* Simulation::begin_tick() {
  apply_moves();
  last_first_move_ = std::exchange(first_move_, next_move_);
  const Change* change = apply_changes();
  for (unsigned joint = 0; joint < chain_.joint_count(); ++joint) {
    touch_.sample(plant_.link_contacts(), joint);
  }
  touch_.write_links(latched_contacts_);
  if (needs_readings_) {
    for (unsigned joint = 0; joint < chain_.joint_count(); ++joint) {
      readings_[joint] = readings_[joint].only(chain_.kernel(joint).needed_readings(joint));
      chain_.set_readings(joint, readings_[joint]);
    }
    latched_readings_.swap(readings_);
    read_modules();
  }
  const std::uint32_t present = tick();
  chain_.advance(touch_.contacts());

  servo_pulses_.clear();
  pulse_source_.append(chain_, servo_pulses_);
  if (has_hashes_) {
    setpoint_hash_.append(chain_.setpoints());
    for (const ServoPulse& pulse : servo_pulses_) {
      servo_hash_.append(pulse.command);
    }
  }
  pulse_player_.begin_tick(present, servo_pulses_);
  return change;
}

void Simulation::end_tick() {
  pulse_player_.end_tick();
  if (has_hashes_) {
    world_hash_.append(plant_.world());
  }
}

const Change* Simulation::apply_changes() {
  if (next_change_ >= scenario_.changes.size() || scenario_.changes[next_change_].tick != tick()) {
    return nullptr;
  }
  chain_.apply(scenario_.changes[next_change_]);
  return &scenario_.changes[next_change_++];
}

TickSample Simulation::sample() {
  internal_values_.clear();
  for_each_internal_value(scenario_.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
    internal_values_.push_back(chain_.kernel(joint).internal_value(slot, joint, number));
  });
  return {tick() - 1,
          latched_contacts_,
          chain_.setpoints(),
          internal_values_,
          servo_pulses_,
          plant_.servo_commands(),
          plant_.link_poses(),
          plant_.joint_angles(),
          plant_.motor_torques(),
          plant_.servo_currents(),
          plant_.contact_forces(),
          chain_.lost(),
          std::span(scenario_.moves).subspan(last_first_move_, first_move_ - last_first_move_),
          plant_.object_poses(),
          plant_.sensors().values(),
          plant_.sensors().measured(),
          latched_readings_};
}

}  // namespace proleg::sim
