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
  std::vector<Look> looks;  ///< shown beside the geometries
};

/// An object in the world that moves when something pushes it: a ball, a box. Its geometries are convex.
struct MovingObject {
  std::string name;
  Pose pose;  ///< of its frame in the world, at the start
  MassProperties mass;
  std::vector<Geometry> geometries;
  std::vector<Look> looks;  ///< shown beside the geometries
};

/// A scale on the ground, for the eye only: segments of equal length whose colours alternate.
struct Ruler {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< m, in the world
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< not at `from`
  double division = 1.0;                           ///< m, length of a segment; the last one may be shorter
  double width = 0.1;                              ///< m
};

/// The world a robot crawls in.
struct EnvironmentModel {
  PhysicsEngine engine = PhysicsEngine::ode;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2
  bool self_collision = false;               ///< whether links that are not neighbours collide
  /// Coulomb coefficient between two geometries of which neither has one.
  double unspecified_friction = default_friction;
  std::vector<StaticObject> objects;
  std::vector<MovingObject> moving_objects;
  std::vector<Ruler> rulers;
  Pose robot_pose;  ///< where the robot starts
};

}  // namespace proleg::sim
