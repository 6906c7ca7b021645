#pragma once

#include <cstdint>
#include <vector>

#include "shared/kernel/servo_schedule.hpp"
#include "sim/bus/controller.hpp"
#include "sim/loop/plant.hpp"
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

/// The actions of a tick, by time. An interval's pulse is read in the middle of the interval, or half a millisecond
/// after its start if that is earlier: by then the module has given this pulse and not yet the next. A step is made in
/// its own middle, after the intervals that have started by its start.
inline void schedule_tick(const ServoSchedule& servo, const Plant& plant, std::uint32_t tick,
                          std::uint32_t servo_period_us, std::uint32_t tick_period_us,
                          std::vector<PlantAction>& actions) {
  constexpr std::uint64_t max_wait_us = 500;
  const std::uint64_t tick_start_us = std::uint64_t{tick} * tick_period_us;
  const std::uint64_t wait_us = std::min<std::uint64_t>(servo_period_us / 2, max_wait_us);
  const std::uint64_t half_step = std::uint64_t{tick_period_us} * 1000 / plant.steps_per_tick() / 2;
  const std::uint64_t end = servo.first_interval(std::uint64_t{tick} + 1);
  std::uint64_t interval = servo.first_interval(tick);
  const auto read_time = [&](std::uint64_t n) { return (servo.start_us(n) - tick_start_us + wait_us) * 1000; };

  actions.clear();
  BusTime last_reading = 0;
  for (std::uint32_t step = 0; step < plant.steps_per_tick(); ++step) {
    const std::uint64_t start_us = plant.step_start_us(step);
    for (; interval < end && servo.start_us(interval) - tick_start_us <= start_us; ++interval) {
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
