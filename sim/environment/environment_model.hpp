#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/environment/physics_engine.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// An object in the world that does not move: the floor, a wall, a step.
struct StaticObject {
  std::string name;
  Pose pose;  ///< in the world
  std::vector<Geometry> geometries;
};

/// The world a robot crawls in.
struct EnvironmentModel {
  PhysicsEngine engine = PhysicsEngine::ode;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2
  bool self_collision = false;               ///< whether links that are not neighbours collide
  /// Coulomb coefficient between two geometries of which neither has one.
  double unspecified_friction = default_friction;
  std::vector<StaticObject> objects;
  Pose robot_pose;  ///< where the robot starts
};

}  // namespace proleg::sim
