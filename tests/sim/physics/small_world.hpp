#pragma once

// Chains of boxes on a floor, for the tests of both physics engines.

#include <cmath>
#include <cstddef>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"
#include "tests/sim/physics/box_link.hpp"

namespace proleg::sim {

inline constexpr double step_s = 0.001;
inline constexpr double gravity = 9.81;

/// Links of 100 mm along y, the head foremost, hinges between them about x.
inline RobotModel chain(std::size_t links) {
  RobotModel robot;
  for (std::size_t i = 0; i < links; ++i) {
    robot.links.push_back(box_link(-0.1 * static_cast<double>(i), {0.02, 0.04, 0.02}, 0.1));
  }
  for (std::size_t i = 0; i + 1 < links; ++i) {
    Joint joint;
    joint.anchor = {0, -0.05 - 0.1 * static_cast<double>(i), 0};
    joint.lower_limit = -1.0;
    joint.upper_limit = 1.0;
    joint.max_torque = 2.0;
    joint.max_speed = 4.5;
    robot.joints.push_back(joint);
  }
  return robot;
}

inline StaticObject floor_with_friction(double friction) {
  StaticObject floor;
  floor.pose.position = {0, 0, -0.5};
  Geometry geometry;
  geometry.extents = {50, 50, 0.5};
  geometry.friction = friction;
  floor.geometries.push_back(geometry);
  return floor;
}

inline EnvironmentModel flat_ground(double friction, double start_height) {
  EnvironmentModel environment;
  environment.objects.push_back(floor_with_friction(friction));
  environment.robot_pose.position = {0, 0, start_height};
  return environment;
}

inline void run(World& world, double seconds) {
  for (long i = 0; i < std::lround(seconds / step_s); ++i) {
    world.step();
  }
}

}  // namespace proleg::sim
