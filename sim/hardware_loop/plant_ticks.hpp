#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/kernel/servo_pulses.hpp"
#include "sim/bus/controller.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

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

/// The actions of a tick, by time. A step of the physics is made when half of its time has passed, or later if pulses
/// on which the servos act at its start are read later.
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

/// Moves servos and world through the ticks of the loop: reads the servos' pulses and makes the steps of the physics,
/// each at its time after the SYNC.
class PlantTicks {
 public:
  /// The pulse that the servo of a joint gets now.
  using ReadPulse = std::function<std::optional<std::int32_t>(std::uint32_t joint)>;
  /// The pulse of a servo's interval; nothing if the servo got none.
  struct Reading {
    std::uint64_t time_us;  ///< start of the servo's interval, since SYNC 0
    std::uint32_t joint;
    std::optional<std::int32_t> pulse;
  };

  /// Called with the time before pulses are read, and before the servo readings of the plant change.
  using BeforeAction = std::function<void(BusTime now)>;

  /// scenario, plant: must outlive this.
  PlantTicks(const Scenario& scenario, Plant& plant, ReadPulse read_pulse, BeforeAction before_action = {});

  /// Begins a tick, counted from 0, at its SYNC. The tick before may still have pending readings.
  void begin(std::uint32_t tick, BusTime sync);
  /// The time of the next reading, step or complete().
  [[nodiscard]] BusTime next_event() const;
  void advance_to(BusTime now);

  /// At the next SYNC, before the modules receive it. Makes the remaining steps. Readings of intervals that start late
  /// in the tick stay pending: by its own crystal a module may begin such an interval just after the SYNC, and its
  /// program takes time. The world makes no step of the next tick before complete(). setpoints: as in
  /// Plant::finish_tick().
  void end(BusTime now, std::span<const std::int32_t> setpoints = {});
  [[nodiscard]] bool has_ended() const { return ended_; }
  /// Whether complete() is due: all modules have given their last pulses.
  [[nodiscard]] bool is_complete(BusTime now) const { return ended_ && completion_ <= now; }
  /// The servos take the last pulses of the tick.
  void complete();

  /// The readings of the last completed tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const Reading> readings() const { return completed_; }
  /// The readings that came too late for a step of the physics: the SYNC was early by more than acting_time_us()
  /// allows (sim/loop/pulse_player.hpp). The servos acted on these pulses from the next tick on.
  [[nodiscard]] std::span<const Reading> late_readings() const { return late_; }

 private:
  void act(const PlantAction& action, BusTime now);
  void announce(BusTime now) const;
  void take_readings(std::uint64_t until_us);
  [[nodiscard]] std::uint64_t acting_time(const Reading& reading) const;

  const Scenario& scenario_;
  Plant& plant_;
  ReadPulse read_pulse_;
  BeforeAction before_action_;
  ServoSchedule servo_schedule_;
  std::uint32_t tick_ = 0;  ///< number of completed ticks
  BusTime sync_ = 0;        ///< of the last begin()
  std::vector<PlantAction> actions_;
  std::size_t next_action_ = 0;
  bool ended_ = false;
  BusTime completion_ = 0;
  std::vector<PlantAction> pending_;
  std::vector<Reading> readings_;
  std::vector<Reading> completed_;
  std::vector<Reading> late_;
  std::size_t taken_ = 0;  ///< number of readings that the servos have taken
};

}  // namespace proleg::sim
