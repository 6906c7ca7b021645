#pragma once

namespace proleg::sim {

/// How a robot's contact points with its environment slid in a step of the physics.
struct ContactSliding {
  double normal_force = 0.0;       ///< N, sum over the points
  double force_times_speed = 0.0;  ///< N m/s, sum over the points of normal force times sliding speed
  double friction_power = 0.0;     ///< W, that friction takes from the robot
};

}  // namespace proleg::sim
