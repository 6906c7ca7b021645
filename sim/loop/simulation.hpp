#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/kernel/kernel.hpp"
#include "sim/physics/world.hpp"
#include "sim/record/hash.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A scenario running: one kernel for all joints, servos, and the world, tick by tick. The same scenario gives the same
/// numbers on every run.
class Simulation {
 public:
  explicit Simulation(const Scenario& scenario);

  /// One tick: SYNC k, then the world until SYNC k + 1. Returns the change that took effect at k, if any.
  const Change* advance();

  [[nodiscard]] std::uint32_t tick() const { return kernel_.tick(); }
  [[nodiscard]] double time_s() const;
  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  [[nodiscard]] const World& world() const { return world_; }

  // As of the coming SYNC.
  [[nodiscard]] std::span<const std::int32_t> servo_commands() const { return servo_commands_; }
  [[nodiscard]] std::span<const Pose> link_poses() const { return link_poses_; }
  [[nodiscard]] std::span<const double> joint_angles() const { return joint_angles_; }
  [[nodiscard]] std::span<const std::uint8_t> link_contacts() const { return link_contacts_; }

  /// Horizontal distance, in m, of the centre of mass from its start (thesis, equation 3.7).
  [[nodiscard]] double displacement() const;
  /// Contact points in a physics step, on average.
  [[nodiscard]] double mean_contacts() const;
  /// Hash of all set-points, and of all commands the servos took, in kernel order, in the order of time.
  [[nodiscard]] const SetpointHash& setpoint_hash() const { return setpoint_hash_; }
  [[nodiscard]] const SetpointHash& servo_hash() const { return servo_hash_; }

 private:
  const Change* apply_changes();
  void latch_contacts();
  void take_servo_commands(std::uint32_t elapsed_us);
  void read_world();

  const Scenario& scenario_;
  std::vector<JointMemory> joint_memory_;
  Kernel kernel_;
  World world_;
  std::uint32_t steps_per_tick_;
  std::uint64_t next_servo_us_ = 0;
  std::size_t next_change_ = 0;
  std::uint64_t contact_sum_ = 0;
  Eigen::Vector3d start_;
  std::vector<std::int32_t> servo_commands_;
  std::vector<Pose> link_poses_;
  std::vector<double> joint_angles_;
  std::vector<std::uint8_t> link_contacts_;
  SetpointHash setpoint_hash_;
  SetpointHash servo_hash_;
};

}  // namespace proleg::sim
