#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// The smallest axis-aligned box around a shape.
struct Bounds {
  Eigen::Vector3d lowest;
  Eigen::Vector3d highest;
};

/// Around both.
[[nodiscard]] inline Bounds joined(const Bounds& one, const Bounds& other) {
  return {one.lowest.cwiseMin(other.lowest), one.highest.cwiseMax(other.highest)};
}

/// Whether a point is above, in or below the box: seen from above, the box contains it.
[[nodiscard]] inline bool contains_from_above(const Bounds& bounds, const Eigen::Vector3d& point) {
  return (point.head<2>().array() >= bounds.lowest.head<2>().array()).all() &&
         (point.head<2>().array() <= bounds.highest.head<2>().array()).all();
}

/// Bounds of a mesh, which has at least one vertex.
[[nodiscard]] inline Bounds bounds_of(const TriangleMesh& mesh, const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  const Eigen::Vector3d first = rotation * mesh.vertices.front();
  Bounds bounds{first, first};
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3d turned = rotation * vertex;
    bounds = {bounds.lowest.cwiseMin(turned), bounds.highest.cwiseMax(turned)};
  }
  return {bounds.lowest + pose.position, bounds.highest + pose.position};
}

/// Bounds of a geometry; `frame` is the pose of its body.
[[nodiscard]] inline Bounds bounds_of(const Geometry& geometry, const Pose& frame) {
  const Pose pose = frame * geometry.pose;
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  Eigen::Vector3d reach = Eigen::Vector3d::Constant(geometry.extents.x());  // of a sphere
  switch (geometry.shape) {
    case Shape::hull:
    case Shape::surface:
    case Shape::height_field:
      return bounds_of(*geometry.mesh, pose);
    case Shape::box:
      reach = rotation.cwiseAbs() * geometry.extents;
      break;
    case Shape::sphere:
      break;
    case Shape::cylinder:
      for (Eigen::Index i = 0; i < 3; ++i) {
        const double along = std::min(std::abs(rotation(i, 1)), 1.0);  // share of the cylinder's axis in this direction
        reach[i] = geometry.extents.y() * along + geometry.extents.x() * std::sqrt(1.0 - along * along);
      }
      break;
  }
  return {pose.position - reach, pose.position + reach};
}

/// Bounds of all geometries of a body; nothing if there are none. frame: the pose of the body.
[[nodiscard]] inline std::optional<Bounds> bounds_of(const std::vector<Geometry>& geometries, const Pose& frame) {
  std::optional<Bounds> whole;
  for (const Geometry& geometry : geometries) {
    const Bounds bounds = bounds_of(geometry, frame);
    whole = whole ? joined(*whole, bounds) : bounds;
  }
  return whole;
}

}  // namespace proleg::sim
