#pragma once

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// A link that is a box of even density. y in m is where its middle is, half_sides in m, mass in kg.
inline Link box_link(double y, const Eigen::Vector3d& half_sides, double mass) {
  Link link;
  link.pose.position = {0, y, 0};
  const Eigen::Vector3d sides = 2 * half_sides;
  const Eigen::Vector3d squares = sides.cwiseProduct(sides);
  link.mass.mass = mass;
  link.mass.inertia =
      (mass / 12 * Eigen::Vector3d(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()))
          .asDiagonal();
  Geometry geometry;
  geometry.extents = half_sides;
  link.geometries.push_back(geometry);
  return link;
}

}  // namespace proleg::sim
