#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

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

/// Height of the highest point of a mesh over a level rectangle, in the world; nothing if no triangle is above or below
/// it. pose: of the mesh in the world. low, high: corners of the rectangle, which may be a point.
[[nodiscard]] inline std::optional<double> highest_over(const TriangleMesh& mesh, const Pose& pose,
                                                        const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  std::optional<double> top;
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    vertices.push_back(pose * vertex);
  }
  std::vector<Eigen::Vector3d> part;
  std::vector<Eigen::Vector3d> cut;
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const auto is_beside = [&](Eigen::Index axis) {
      const auto all = [&](const auto& is_out) {
        return std::all_of(triangle.begin(), triangle.end(),
                           [&](std::uint32_t corner) { return is_out(vertices[corner][axis]); });
      };
      return all([&](double at) { return at < low[axis]; }) || all([&](double at) { return at > high[axis]; });
    };
    if (is_beside(0) || is_beside(1)) {
      continue;
    }
    part.clear();
    for (const std::uint32_t corner : triangle) {
      part.push_back(vertices[corner]);
    }
    // The part of the triangle within the rectangle: one side of the rectangle after the other cuts the rest away.
    for (Eigen::Index side = 0; side < 4 && !part.empty(); ++side) {
      const Eigen::Index axis = side / 2;
      const double sign = side % 2 == 0 ? 1.0 : -1.0;
      const double limit = sign * (side % 2 == 0 ? low : high)[axis];
      cut.clear();
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Eigen::Vector3d& a = part[i];
        const Eigen::Vector3d& b = part[(i + 1) % part.size()];
        const double at_a = sign * a[axis] - limit;
        const double at_b = sign * b[axis] - limit;
        if (at_a >= 0.0) {
          cut.push_back(a);
        }
        if ((at_a >= 0.0) != (at_b >= 0.0)) {
          cut.emplace_back(a + (b - a) * (at_a / (at_a - at_b)));
        }
      }
      part.swap(cut);
    }
    for (const Eigen::Vector3d& corner : part) {
      top = std::max(top.value_or(corner.z()), corner.z());
    }
  }
  return top;
}

}  // namespace proleg::sim
