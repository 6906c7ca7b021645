#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/kernel/servo_schedule.hpp"
#include "sim/hardware_loop/plant_schedule.hpp"
#include "sim/loop/plant.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

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

  /// At the SYNC of a tick, counted from 0. The tick before may still have pending readings.
  void begin(std::uint32_t tick, BusTime sync);
  /// The time of the next reading, step or complete().
  [[nodiscard]] BusTime next_event() const;
  void advance_to(BusTime now);

  /// At the next SYNC, before the modules receive it. Makes the remaining steps. Readings of intervals that start late
  /// in the tick stay pending: by its own crystal a module may begin such an interval just after the SYNC, and its
  /// program takes time. The world makes no step of the next tick before complete().
  void end(BusTime now);
  [[nodiscard]] bool has_ended() const { return ended_; }
  /// Whether complete() is due: all modules have given their last pulses.
  [[nodiscard]] bool is_complete(BusTime now) const { return ended_ && completion_ <= now; }
  /// The servos take the last pulses of the tick.
  void complete();

  /// The readings of the last completed tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const Reading> readings() const { return completed_; }
  /// Those of them that came too late for a step of the physics: the SYNC was early by more than pulse_timing.hpp
  /// allows. The servos acted on these pulses from the next tick on.
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
