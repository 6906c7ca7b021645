#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/kernel/kernel.hpp"
#include "sim/physics/world.hpp"
#include "sim/record/hash.hpp"
#include "sim/record/recorder.hpp"
#include "sim/robot/servo_schedule.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A scenario running: one kernel for all joints, servos, and the world, tick by tick. The same scenario gives the same
/// numbers on every run.
class Simulation {
 public:
  /// scenario: must outlive the simulation, which keeps a reference to it.
  explicit Simulation(const Scenario& scenario);
  explicit Simulation(const Scenario&& scenario) = delete;

  /// One tick: SYNC k, then the world until SYNC k + 1. Returns the change that took effect at k, if any.
  /// Throws PhysicsError if the engine gave up, the robot moves faster than 100 m/s or fell off its environment.
  const Change* advance();

  [[nodiscard]] std::uint32_t tick() const { return kernel_.tick(); }
  [[nodiscard]] double time_s() const;
  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  [[nodiscard]] const World& world() const { return world_; }

  // Of the last tick, k = tick() - 1; before the first tick they are empty or 0.
  /// Per link, as link_contacts(): what the kernel was given at SYNC k, and so what the frames labelled k + 1 say.
  [[nodiscard]] std::span<const std::uint8_t> latched_contacts() const { return latched_contacts_; }
  /// out(k + 1) of each joint.
  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return setpoints_; }
  /// Those of state k + 1: slot by slot, in each the joints of its group, of each joint all values.
  [[nodiscard]] std::span<const std::int32_t> internal_values() const { return internal_values_; }
  /// The pulses of the servo intervals that start in the tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const ServoPulse> servo_pulses() const { return servo_pulses_; }
  /// All of it, to be recorded. Only after a tick; valid until the next advance().
  [[nodiscard]] TickSample sample() const;

  // As of the coming SYNC.
  /// The last pulse of each servo.
  [[nodiscard]] std::span<const std::int32_t> servo_commands() const { return servo_commands_; }
  [[nodiscard]] std::span<const Pose> link_poses() const { return link_poses_; }
  [[nodiscard]] std::span<const double> joint_angles() const { return joint_angles_; }
  [[nodiscard]] std::span<const std::uint8_t> link_contacts() const { return link_contacts_; }

  /// Horizontal distance, in m, of the centre of mass from its start (thesis, equation 3.7).
  [[nodiscard]] double displacement() const;
  /// Contact points in a physics step, on average.
  [[nodiscard]] double mean_contacts() const;
  /// Hash of all set-points, and of all pulses, in kernel order, in the order of time.
  [[nodiscard]] const ValueHash& setpoint_hash() const { return setpoint_hash_; }
  [[nodiscard]] const ValueHash& servo_hash() const { return servo_hash_; }

 private:
  const Change* apply_changes();
  void require_crawling(const Eigen::Vector3d& center_before) const;
  void latch_contacts();
  void read_kernel();
  void compute_servo_pulses();
  void take_servo_pulses(std::uint64_t until_us);
  void read_world();

  const Scenario& scenario_;
  std::vector<JointMemory> joint_memory_;
  Kernel kernel_;
  World world_;
  std::uint32_t steps_per_tick_;
  ServoSchedule servo_schedule_;
  std::size_t next_change_ = 0;
  std::uint64_t contact_sum_ = 0;
  Eigen::Vector3d start_;
  std::vector<std::uint8_t> latched_contacts_;
  std::vector<std::int32_t> setpoints_;
  std::vector<std::int32_t> internal_values_;
  std::vector<ServoPulse> servo_pulses_;
  std::size_t taken_pulses_ = 0;
  std::vector<std::int32_t> servo_commands_;
  std::vector<Pose> link_poses_;
  std::vector<double> joint_angles_;
  std::vector<std::uint8_t> link_contacts_;
  ValueHash setpoint_hash_;
  ValueHash servo_hash_;
};

}  // namespace proleg::sim
