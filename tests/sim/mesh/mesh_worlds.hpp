#pragma once

// Robots and grounds that are meshes, and objects that move.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "sim/mesh/mesh_geometry.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim {

inline Geometry surface(TriangleMesh mesh, double friction) {
  Geometry geometry;
  geometry.shape = Shape::surface;
  geometry.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
  geometry.friction = friction;
  return geometry;
}

inline Geometry height_field(const HeightField& field, double friction) {
  Geometry geometry = surface(surface_of(field), friction);
  geometry.shape = Shape::height_field;
  geometry.heights = std::make_shared<const HeightField>(field);
  return geometry;
}

inline EnvironmentModel world_of(Geometry ground, double start_height) {
  EnvironmentModel environment;
  StaticObject object;
  object.name = "ground";
  object.geometries.push_back(std::move(ground));
  environment.objects.push_back(object);
  environment.robot_pose.position.z() = start_height;
  return environment;
}

/// A robot of one link: a convex mesh with the mass of its box.
inline RobotModel hull_robot(const TriangleMesh& mesh, const Eigen::Vector3d& half_sides) {
  RobotModel robot;
  robot.links.push_back(box_link(0.0, half_sides, 0.1));
  Geometry& geometry = robot.links[0].geometries[0];
  geometry.shape = Shape::hull;
  geometry.mesh = std::make_shared<const TriangleMesh>(convex_hull(mesh).mesh);
  return robot;
}

inline MovingObject box_object(const Eigen::Vector3d& position, const Eigen::Vector3d& half_sides, double mass,
                               double friction) {
  const Link link = box_link(0.0, half_sides, mass);
  MovingObject object{"box", {}, link.mass, link.geometries, {}};
  object.pose.position = position;
  object.geometries[0].friction = friction;
  return object;
}

inline std::vector<Pose> objects_of(const World& world, std::size_t count) {
  std::vector<Pose> poses(count);
  world.read_objects(poses);
  return poses;
}

/// Gravity as on a slope along a direction in the plane of the ground.
inline Eigen::Vector3d tilted(double slope, double heading) {
  return gravity *
         Eigen::Vector3d(std::sin(slope) * std::cos(heading), std::sin(slope) * std::sin(heading), -std::cos(slope));
}

/// Expects a hull of a box of 40 x 80 x 40 mm to slide down a slope as the box does. Friction 0.5 does not hold it
/// there.
inline void expect_to_slide_as_a_box(
    const std::function<std::unique_ptr<World>(const RobotModel&, const EnvironmentModel&)>& make,
    EnvironmentModel environment) {
  const Eigen::Vector3d half(0.02, 0.04, 0.02);
  environment.gravity = tilted(1.3 * std::atan(0.5), 0.0);
  const std::unique_ptr<World> box = make(chain(1), environment);
  const std::unique_ptr<World> hull = make(hull_robot(box_mesh(half), half), environment);
  run(*box, 0.5);
  run(*hull, 0.5);
  EXPECT_NEAR(hull->center_of_mass().x(), box->center_of_mass().x(), 0.02 * box->center_of_mass().x());
  EXPECT_NEAR(hull->center_of_mass().z(), 0.02, 1e-4);
  EXPECT_GT(box->center_of_mass().x(), 0.1);
}

}  // namespace proleg::sim
