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
    begin_tick(tick, pulses);
    for (std::uint32_t step = 0; step < plant_.steps_per_tick(); ++step) {
      begin_step(step);
      plant_.finish_step();
    }
    end_tick();
  }

  // The parts of advance(), for worlds that make their steps together (Plant::begin_step). pulses: must stay until
  // end_tick().
  void begin_tick(std::uint32_t tick, std::span<const ServoPulse> pulses) {
    start_us_ = std::uint64_t{tick} * schedule_.tick_period_us();
    pulses_ = pulses;
    taken_ = 0;
  }
  void begin_step(std::uint32_t step) {
    take(start_us_ + plant_.step_start_us(step));
    plant_.begin_step();
  }
  void end_tick() {
    // Pulses on which the servos act after the last step count for the next tick.
    plant_.finish_tick();
    take(start_us_ + schedule_.tick_period_us());
  }

 private:
  /// The servos take the pulses on which they act by then.
  void take(std::uint64_t until_us) {
    const std::uint64_t next_sync_us = start_us_ + schedule_.tick_period_us();
    for (; taken_ < pulses_.size(); ++taken_) {
      const ServoPulse& pulse = pulses_[taken_];
      if (acting_time_before_sync_us(pulse.time_us, schedule_.servo_period_us(), next_sync_us) > until_us) {
        return;
      }
      plant_.set_command(pulse.joint, pulse.command);
    }
  }

  Plant& plant_;
  ServoSchedule schedule_;
  std::uint64_t start_us_ = 0;  ///< of the tick
  std::span<const ServoPulse> pulses_;
  std::size_t taken_ = 0;
};

}  // namespace proleg::sim
