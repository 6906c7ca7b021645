#include "sim/loop/simulation.hpp"

#include <utility>

#include "sim/loop/robot_placement.hpp"

namespace proleg::sim {

Simulation::Simulation(const Scenario& scenario, const Losses* losses) : Simulation(scenario, losses, nullptr) {}

Simulation::Simulation(const Scenario& scenario, std::unique_ptr<World> world)
    : Simulation(scenario, nullptr, std::move(world)) {}

Simulation::Simulation(const Scenario& scenario, const Losses* losses, std::unique_ptr<World> world)
    : scenario_(scenario),
      gait_(scenario),
      plant_(scenario, std::move(world)),
      touch_(scenario.robot.joints.size()),
      pulse_player_(plant_, gait_.schedule()),
      latched_contacts_(scenario.robot.links.size()),
      needs_readings_(gait_.chain().needs_readings()) {
  gait_.chain().set_losses(losses);
  if (needs_readings_) {
    read_modules();
  }
}

void Simulation::read_modules() {
  readings_.clear();
  for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
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
  const Change* const change = gait_.apply_due_changes();
  for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
    touch_.sample(plant_.link_contacts(), joint);
  }
  touch_.write_links(latched_contacts_);
  if (needs_readings_) {
    for (unsigned joint = 0; joint < chain().joint_count(); ++joint) {
      readings_[joint] = readings_[joint].only(chain().kernel(joint).needed_readings(joint));
      gait_.chain().set_readings(joint, readings_[joint]);
    }
    latched_readings_.swap(readings_);
    read_modules();
  }
  const std::uint32_t present = tick();
  gait_.advance(touch_.contacts());
  if (has_hashes_) {
    setpoint_hash_.append(setpoints());
    for (const ServoPulse& pulse : servo_pulses()) {
      servo_hash_.append(pulse.command);
    }
  }
  pulse_player_.begin_tick(present, servo_pulses());
  return change;
}

void Simulation::end_tick() {
  pulse_player_.end_tick();
  if (has_hashes_) {
    world_hash_.append(plant_.world());
  }
}

TickSample Simulation::sample() {
  TickSample sample = gait_.sample();
  plant_.add_to(sample);
  sample.latched_contacts = latched_contacts_;
  sample.moves = std::span(scenario_.moves).subspan(last_first_move_, first_move_ - last_first_move_);
  sample.readings = latched_readings_;
  return sample;
}

}  // namespace proleg::sim
