#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "shared/kernel/servo_schedule.hpp"
#include "sim/bus/controller.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_timing.hpp"
#include "sim/robot/servo_pulse.hpp"

namespace proleg::sim {

/// An action of the loop on servos or world within a tick.
struct PlantAction {
  enum class Kind : std::uint8_t {
    read_servos,  ///< read the pulses of an interval
    step,         ///< make a step of the physics
  };
  BusTime time;  ///< after the SYNC
  Kind kind;
  std::uint64_t number;  ///< of the interval since SYNC 0, or of the step in the tick
};

/// The actions of a tick, by time. A step is made in its own middle, or later: after the readings of all pulses on
/// which the servos act at its start.
inline void schedule_tick(const ServoSchedule& servo, const Plant& plant, std::uint32_t tick,
                          std::uint32_t servo_period_us, std::uint32_t tick_period_us,
                          std::vector<PlantAction>& actions) {
  const std::uint64_t tick_start_us = std::uint64_t{tick} * tick_period_us;
  const std::uint64_t wait_us = pulse_reading_delay_us(servo_period_us);
  const std::uint64_t half_step = std::uint64_t{tick_period_us} * 1000 / plant.steps_per_tick() / 2;
  const std::uint64_t end = servo.first_interval(std::uint64_t{tick} + 1);
  std::uint64_t interval = servo.first_interval(tick);
  const auto read_time = [&](std::uint64_t n) { return (servo.start_us(n) - tick_start_us + wait_us) * 1000; };

  actions.clear();
  BusTime last_reading = 0;
  for (std::uint32_t step = 0; step < plant.steps_per_tick(); ++step) {
    const std::uint64_t start_us = plant.step_start_us(step);
    const auto acts = [&](std::uint64_t n) {
      return acting_time_us(servo.start_us(n), servo_period_us, tick_period_us) <= tick_start_us + start_us;
    };
    for (; interval < end && acts(interval); ++interval) {
      last_reading = read_time(interval);
      actions.push_back({last_reading, PlantAction::Kind::read_servos, interval});
    }
    actions.push_back({std::max(start_us * 1000 + half_step, last_reading), PlantAction::Kind::step, step});
  }
  for (; interval < end; ++interval) {
    actions.push_back({read_time(interval), PlantAction::Kind::read_servos, interval});
  }
  // A reading may come before a step that does not use it.
  std::ranges::stable_sort(actions, {}, &PlantAction::time);
}

}  // namespace proleg::sim
