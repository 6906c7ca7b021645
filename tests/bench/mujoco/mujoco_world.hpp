#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "tests/bench/mujoco/mujoco_model.hpp"

namespace proleg::bench {

/// What sim/physics' World is, in MuJoCo: a robot that crawls on its environment by the speeds of its joints.
///
/// The motor of a joint is to reach its speed by the end of the step with the torque it has, as that of sim/physics.
/// MuJoCo has a constraint that does just this for the speed 0: dry friction of a joint. Here it is given the speed. (A
/// velocity actuator with a force range is not the same: its force is computed from the speed at the start of the step,
/// so it is either soft or always at its limit.)
class MujocoWorld {
 public:
  /// model: of write_mjcf(); must outlive the world.
  explicit MujocoWorld(const mjModel& model);

  /// The speed, in rad/s, that the motor of a joint is to reach.
  void set_joint_speed(std::size_t joint, double speed) { speeds_[joint] = speed; }
  /// Throws std::runtime_error if MuJoCo had something to complain about.
  void step();

  /// rad, as RobotModel defines it.
  [[nodiscard]] double joint_angle(std::size_t joint) const { return data_->qpos[angle_place_[joint]]; }
  /// Of the robot, in the world.
  [[nodiscard]] Eigen::Vector3d center_of_mass();
  /// Contact points at the start of the last step.
  [[nodiscard]] std::size_t contact_count() const { return static_cast<std::size_t>(data_->ncon); }

 private:
  void aim_motors();

  const mjModel& model_;
  MujocoData data_;
  std::vector<double> speeds_;
  std::vector<int> angle_place_;       ///< of each joint, in qpos
  std::vector<std::size_t> joint_of_;  ///< of each degree of freedom
};

}  // namespace proleg::bench
