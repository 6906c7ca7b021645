#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/loop/gait.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Robots, each in a world of its own, whose set-points come from outside at each tick instead of from the gait of a
/// scenario: for programs that learn. All make their ticks together. From a set-point on, everything is as in a
/// Simulation: limits, pulses, servos, world. So the set-points of a Simulation give its motion, bit for bit.
class DrivenWorlds {
 public:
  /// scenarios: at least one, with the same number of joints, tick and step; of each the robot, the world and the seed
  /// count, but neither its gait nor its moves. They must outlive this. start: set-points before the first tick, for
  /// each world those of its joints from the head. Throws InputError if the engine does not have what one of them
  /// needs, or for scenarios that differ.
  DrivenWorlds(std::span<const Scenario* const> scenarios, std::span<const std::int32_t> start);
  ~DrivenWorlds();
  DrivenWorlds(const DrivenWorlds&) = delete;
  DrivenWorlds& operator=(const DrivenWorlds&) = delete;

  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] std::size_t joint_count() const { return joint_count_; }

  /// A tick of all worlds that run. setpoints: those at its end, 90 degrees = 2^30, for each world those of its joints
  /// from the head; they are cut to the limits of the joints. A world that fails stops.
  void advance(std::span<const std::int32_t> setpoints);

  /// Ticks so far.
  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  /// The servos and the world of a robot.
  [[nodiscard]] const Plant& plant(std::size_t i) const;
  /// Per link, bit 0 rear, bit 1 front sensor, debounced as modules do it: what a gait would be given at the coming
  /// SYNC.
  [[nodiscard]] std::span<const std::uint8_t> contacts(std::size_t i) const;
  /// The set-points of the last tick, within the limits.
  [[nodiscard]] std::span<const std::int32_t> setpoints(std::size_t i) const;
  [[nodiscard]] bool runs(std::size_t i) const;
  /// Why a world failed; empty if it did not.
  [[nodiscard]] const std::string& failure(std::size_t i) const;

 private:
  struct Member;

  template <typename Do>
  void for_all(const Do& act);

  std::unique_ptr<reduced::ReducedWorlds> together_;  ///< null: each world makes its own steps
  std::vector<std::unique_ptr<Member>> members_;
  std::size_t joint_count_;
  std::uint32_t tick_ = 0;
};

}  // namespace proleg::sim
