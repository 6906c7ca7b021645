#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/kernel/servo_schedule.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_timing.hpp"
#include "sim/robot/servo_pulse.hpp"

namespace proleg::sim {

/// Moves servos and world through ticks whose pulses are known.
class PulsePlayer {
 public:
  /// plant: must outlive this.
  PulsePlayer(Plant& plant, const ServoSchedule& schedule) : plant_(plant), schedule_(schedule) {}

  /// The world from SYNC k, k = tick, until SYNC k + 1. pulses: of the servo intervals that start in the tick, in the
  /// order of time, then of joints. Throws PhysicsError as Plant does.
  void advance(std::uint32_t tick, std::span<const ServoPulse> pulses) {
    const std::uint64_t start_us = std::uint64_t{tick} * schedule_.tick_period_us();
    taken_ = 0;
    for (std::uint32_t step = 0; step < plant_.steps_per_tick(); ++step) {
      take(pulses, start_us + plant_.step_start_us(step));
      plant_.step();
    }
    // Pulses on which the servos act after the last step count for the next tick.
    plant_.finish_tick();
    take(pulses, start_us + schedule_.tick_period_us());
  }

 private:
  /// The servos take the pulses on which they act by then.
  void take(std::span<const ServoPulse> pulses, std::uint64_t until_us) {
    for (; taken_ < pulses.size(); ++taken_) {
      const ServoPulse& pulse = pulses[taken_];
      if (acting_time_us(pulse.time_us, schedule_.servo_period_us(), schedule_.tick_period_us()) > until_us) {
        return;
      }
      plant_.set_command(pulse.joint, pulse.command);
    }
  }

  Plant& plant_;
  ServoSchedule schedule_;
  std::size_t taken_ = 0;
};

}  // namespace proleg::sim
