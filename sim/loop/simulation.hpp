#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/hash/sha256.hpp"
#include "sim/loop/gait.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/measure/gait_meter.hpp"
#include "sim/measure/measure.hpp"
#include "sim/record/recorder.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Runs a scenario tick by tick: the joints' kernels in memory, servos, and the world. The same scenario gives the same
/// numbers on every run.
class Simulation {
 public:
  /// scenario, losses: must outlive the simulation, which keeps references to them. losses: null for none.
  explicit Simulation(const Scenario& scenario, const Losses* losses = nullptr);
  explicit Simulation(const Scenario&& scenario, const Losses* losses = nullptr) = delete;
  /// A simulation with a world that was made for the scenario.
  Simulation(const Scenario& scenario, std::unique_ptr<World> world);

  /// Leaves out the hashes, which take a tenth of the time: those below stay the hashes of no values. For evaluations,
  /// which need none.
  void leave_out_hashes() { has_hashes_ = false; }

  /// The moves of the present tick take effect now. Otherwise advance() begins with them. Throws InputError for a move
  /// to a place where the robot cannot be put; then only the moves before it have taken effect.
  void apply_moves();
  /// Whether moves of the present tick have taken effect.
  [[nodiscard]] bool was_moved() const { return next_move_ > first_move_; }

  /// One tick: SYNC k, then the world until SYNC k + 1. Returns the change that took effect at k, if any.
  /// Throws as apply_moves(), and PhysicsError if the engine fails, the robot moves faster than 100 m/s or fell off its
  /// environment.
  const Change* advance();

  // The parts of advance(), for simulations whose worlds make their steps together (simulation_batch.hpp).
  const Change* begin_tick();
  void begin_step(std::uint32_t step) { pulse_player_.begin_step(step); }
  void finish_step() { plant_.finish_step(); }
  void end_tick();

  [[nodiscard]] std::uint32_t tick() const { return gait_.tick(); }
  [[nodiscard]] double time_s() const;
  [[nodiscard]] const KernelChain& chain() const { return gait_.chain(); }
  [[nodiscard]] const Plant& plant() const { return plant_; }

  /// The measures of the run so far; before the first tick none is defined. heading_deg: direction of the measure
  /// `speed`, relative to the direction of the head at the start; 90 is to its left. Takes about a millisecond.
  [[nodiscard]] MeasureValues measures(double heading_deg = 0.0) const { return plant_.meter().values(heading_deg); }
  /// Share of a stride that each link is on the ground, from the head.
  [[nodiscard]] std::vector<double> link_duty_factors() const { return plant_.meter().link_duty_factors(); }

  // Of the last tick, k = tick() - 1; before the first tick they are empty or 0.
  /// Per link, bit 0 rear, bit 1 front sensor, debounced: the contacts that the kernels took at SYNC k. The frames
  /// labelled k + 1 carry them.
  [[nodiscard]] std::span<const std::uint8_t> latched_contacts() const { return latched_contacts_; }
  /// out(k + 1) of each joint.
  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return chain().setpoints(); }
  /// The pulses of the servo intervals that start in the tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const ServoPulse> servo_pulses() const { return gait_.pulses(); }
  /// The last tick, as a recorder takes it. Only after a tick; valid until the next advance().
  [[nodiscard]] TickSample sample();

  /// Hashes of all set-points and of all pulses, in the order of time, then of joints.
  [[nodiscard]] const ValueHash& setpoint_hash() const { return setpoint_hash_; }
  [[nodiscard]] const ValueHash& servo_hash() const { return servo_hash_; }
  /// Hash of the states of the world after all ticks; nothing if its engine does not give the same on every computer.
  [[nodiscard]] std::optional<std::string> world_hash() const { return world_hash_.hex(); }
  /// Hash of the motion (sim/record/motion.hpp).
  [[nodiscard]] std::string motion_hash() const { return world_hash_.motion_hex(); }

 private:
  void read_modules();
  Simulation(const Scenario& scenario, const Losses* losses, std::unique_ptr<World> world);

  const Scenario& scenario_;
  Gait gait_;
  Plant plant_;
  TouchInputs touch_;
  PulsePlayer pulse_player_;
  std::size_t next_move_ = 0;
  std::size_t first_move_ = 0;       ///< of the present tick
  std::size_t last_first_move_ = 0;  ///< of the tick before
  std::vector<std::uint8_t> latched_contacts_;
  bool needs_readings_;
  std::vector<JointReadings> readings_;          ///< by joint, at the SYNC of this tick, for the next
  std::vector<JointReadings> latched_readings_;  ///< those that the kernels got
  bool has_hashes_ = true;
  ValueHash setpoint_hash_;
  ValueHash servo_hash_;
  WorldHash world_hash_;
};

/// The rigid motion of a move: from where the links are to where it puts them. A robot that would be inside or
/// below the environment is put on top of it. Throws InputError if that takes more than a metre, if nothing is below
/// that place, or if it is more than 10 m above the ground.
[[nodiscard]] Pose placement(const RobotMove& move, std::span<const Pose> links, const Scenario& scenario);

}  // namespace proleg::sim
