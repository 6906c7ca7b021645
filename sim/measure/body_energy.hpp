#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// The energies that a robot's body holds while it moves (thesis, equations 2.11 to 2.13), at the ends of the ticks.
class BodyEnergy {
 public:
  /// All joint angles are 0 and the robot rests before the first tick, in the pose of the environment.
  BodyEnergy(const RobotModel& robot, const Pose& start, double gravity, double tick_s);

  /// link_poses: in the world. motor_torques: Nm, mean over the tick; empty if they are not known.
  void add_tick(std::span<const Pose> link_poses, std::span<const double> joint_angles,
                std::span<const double> joint_targets, std::span<const double> motor_torques);

  // Energies in J, means over the ticks; NaN before the first tick.
  /// m g h, where h is the height of the centre of mass above its height at the start.
  [[nodiscard]] double mean_potential() const { return potential_sum_ / static_cast<double>(ticks_); }
  /// Sum of m v^2 / 2 and w I w / 2 over the links, with the mean velocities of the tick.
  [[nodiscard]] double mean_kinetic() const { return kinetic_sum_ / static_cast<double>(ticks_); }
  /// Sum of K x^2 / 2 over the joints, if a servo were a spring that has the servo's torque at its distance from its
  /// target.
  [[nodiscard]] double mean_elastic() const { return elastic_sum_ / static_cast<double>(ticks_); }

 private:
  struct Body {
    MassProperties mass;
    Eigen::Vector3d center;  ///< centre of mass in the world, a tick before
    Eigen::Quaterniond orientation;
  };

  double weight_per_mass_;  ///< m/s^2
  double ticks_per_s_;
  std::vector<Body> bodies_;
  double start_moment_ = 0.0;  ///< sum of mass times height at the start, kg m
  std::uint64_t ticks_ = 0;
  double potential_sum_ = 0.0;
  double kinetic_sum_ = 0.0;
  double elastic_sum_ = 0.0;
};

}  // namespace proleg::sim
