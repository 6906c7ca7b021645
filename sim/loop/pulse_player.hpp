#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/kernel/servo_pulses.hpp"
#include "sim/loop/plant.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {

/// Microseconds from the start of a servo's interval to the moment when the loop reads its pulse from the module: half
/// of the interval, or half a millisecond if that is less. By then the module has given this pulse and not yet the
/// next.
constexpr std::uint32_t pulse_reading_delay_us(std::uint32_t servo_period_us) {
  constexpr std::uint32_t max_delay_us = 500;
  return std::min(servo_period_us / 2, max_delay_us);
}

/// When a simulated servo begins to act on a pulse: microseconds after SYNC 0.
///
/// A pulse acts at the start of the interval. At the end of a tick it acts at the next SYNC instead, if a pulse could
/// be read only after that SYNC. With modules in the loop the world has made the steps of the tick by then, since the
/// modules take their touch sensors at the SYNC. `proleg simulate` follows the same rule and so simulates the same
/// world. Steps of 1 ms and more do not need the rule: no step of the tick starts that late.
///
/// next_sync_us: of the SYNC after the start of the interval.
constexpr std::uint64_t acting_time_before_sync_us(std::uint64_t start_us, std::uint32_t servo_period_us,
                                                   std::uint64_t next_sync_us) {
  // A SYNC may come late, and the next one in time: it waits for a frame on the wire or is sent again after an error.
  constexpr std::uint32_t max_sync_delay_us = 500;
  const bool is_late = start_us + pulse_reading_delay_us(servo_period_us) + max_sync_delay_us > next_sync_us;
  return is_late ? next_sync_us : start_us;
}
constexpr std::uint64_t acting_time_us(std::uint64_t start_us, std::uint32_t servo_period_us,
                                       std::uint32_t tick_period_us) {
  const std::uint64_t next_sync_us = (start_us / tick_period_us + 1) * tick_period_us;
  return acting_time_before_sync_us(start_us, servo_period_us, next_sync_us);
}

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
  // end_tick(). setpoints: as in Plant::finish_tick().
  void begin_tick(std::uint32_t tick, std::span<const ServoPulse> pulses) {
    start_us_ = std::uint64_t{tick} * schedule_.tick_period_us();
    pulses_ = pulses;
    taken_ = 0;
  }
  void begin_step(std::uint32_t step) {
    take(start_us_ + plant_.step_start_us(step));
    plant_.begin_step();
  }
  void end_tick(std::span<const std::int32_t> setpoints = {}) {
    // Pulses on which the servos act after the last step count for the next tick.
    plant_.finish_tick(setpoints);
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
