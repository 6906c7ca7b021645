#include "sim/hardware_loop/plant_ticks.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sim/loop/pulse_player.hpp"

namespace proleg::sim {

PlantTicks::PlantTicks(const Scenario& scenario, Plant& plant, ReadPulse read_pulse, BeforeAction before_action)
    : scenario_(scenario),
      plant_(plant),
      read_pulse_(std::move(read_pulse)),
      before_action_(std::move(before_action)),
      servo_schedule_(scenario.robot.servo.period_us, scenario.kernel.tick_period_us) {}

void PlantTicks::begin(std::uint32_t tick, BusTime sync) {
  sync_ = sync;
  schedule_tick(servo_schedule_, plant_, tick, scenario_.robot.servo.period_us, scenario_.kernel.tick_period_us,
                actions_);
  next_action_ = 0;
}

BusTime PlantTicks::next_event() const {
  if (ended_) {
    return completion_;
  }
  return next_action_ < actions_.size() ? sync_ + actions_[next_action_].time : never_on_bus;
}

void PlantTicks::advance_to(BusTime now) {
  while (!ended_ && next_event() <= now) {
    act(actions_[next_action_++], now);
  }
}

void PlantTicks::announce(BusTime now) const {
  if (before_action_) {
    before_action_(now);
  }
}

void PlantTicks::act(const PlantAction& action, BusTime now) {
  announce(now);
  if (action.kind == PlantAction::Kind::read_servos) {
    for (std::uint32_t joint = 0; joint < scenario_.robot.joints.size(); ++joint) {
      readings_.push_back({servo_schedule_.start_us(action.number), joint, read_pulse_(joint)});
    }
  } else {
    const std::uint64_t tick_start_us = std::uint64_t{tick_} * scenario_.kernel.tick_period_us;
    take_readings(tick_start_us + plant_.step_start_us(static_cast<std::uint32_t>(action.number)));
    plant_.step();
  }
}

void PlantTicks::take_readings(std::uint64_t until_us) {
  for (; taken_ < readings_.size(); ++taken_) {
    const Reading& reading = readings_[taken_];
    if (acting_time(reading) > until_us) {
      return;
    }
    if (reading.pulse) {
      plant_.set_command(reading.joint, *reading.pulse);
    } else {
      plant_.release(reading.joint);
    }
  }
}

std::uint64_t PlantTicks::acting_time(const Reading& reading) const {
  return acting_time_us(reading.time_us, servo_schedule_.servo_period_us(), servo_schedule_.tick_period_us());
}

void PlantTicks::end(BusTime now, std::span<const std::int32_t> setpoints) {
  pending_.clear();
  completion_ = now;
  for (; next_action_ < actions_.size(); ++next_action_) {
    const PlantAction& action = actions_[next_action_];
    if (action.kind == PlantAction::Kind::read_servos) {
      pending_.push_back(action);
      completion_ = std::max(completion_, sync_ + action.time);
    } else {
      act(action, now);
    }
  }
  plant_.finish_tick(setpoints);
  ended_ = true;
}

void PlantTicks::complete() {
  const std::size_t first_pending = readings_.size();
  for (const PlantAction& action : pending_) {
    act(action, completion_);
  }
  const std::uint64_t start_us = std::uint64_t{tick_} * scenario_.kernel.tick_period_us;
  const std::uint64_t last_step_us = start_us + plant_.step_start_us(plant_.steps_per_tick() - 1);
  late_.clear();
  std::ranges::copy_if(std::span(readings_).subspan(first_pending), std::back_inserter(late_),
                       [&](const Reading& reading) { return acting_time(reading) <= last_step_us; });
  announce(completion_);
  take_readings(start_us + scenario_.kernel.tick_period_us);
  ended_ = false;
  ++tick_;
  completed_.swap(readings_);
  readings_.clear();
  taken_ = 0;
}

}  // namespace proleg::sim
