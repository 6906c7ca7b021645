#include "sim/loop/plant_ticks.hpp"

#include <algorithm>
#include <utility>

namespace proleg::sim {

PlantTicks::PlantTicks(const Scenario& scenario, Plant& plant, ReadPulse read_pulse)
    : scenario_(scenario),
      plant_(plant),
      read_pulse_(std::move(read_pulse)),
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
    act(actions_[next_action_++]);
  }
}

void PlantTicks::act(const PlantAction& action) {
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
  for (; taken_ < readings_.size() && readings_[taken_].time_us <= until_us; ++taken_) {
    const Reading& reading = readings_[taken_];
    if (reading.pulse) {
      plant_.set_command(reading.joint, *reading.pulse);
    } else {
      plant_.release(reading.joint);
    }
  }
}

void PlantTicks::end(BusTime now) {
  pending_.clear();
  completion_ = now;
  for (; next_action_ < actions_.size(); ++next_action_) {
    const PlantAction& action = actions_[next_action_];
    if (action.kind == PlantAction::Kind::read_servos) {
      pending_.push_back(action);
      completion_ = std::max(completion_, sync_ + action.time);
    } else {
      act(action);
    }
  }
  plant_.finish_tick();
  ended_ = true;
}

void PlantTicks::complete() {
  for (const PlantAction& action : pending_) {
    act(action);
  }
  take_readings((std::uint64_t{tick_} + 1) * scenario_.kernel.tick_period_us);
  ended_ = false;
  ++tick_;
  completed_.swap(readings_);
  readings_.clear();
  taken_ = 0;
}

}  // namespace proleg::sim
