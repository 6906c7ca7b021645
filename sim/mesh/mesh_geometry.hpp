#pragma once

// The geometry of meshes: their convex hulls, the surfaces of height fields, and the solids within.

#include <Eigen/Geometry>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// The corners that a hull keeps. The time of a contact grows with its triangles.
inline constexpr std::size_t max_hull_corners = 64;

struct ConvexHull {
  TriangleMesh mesh;
  /// m: how far the farthest point of the solid is outside of `mesh`; 0 if no corner was left out.
  double deviation = 0.0;
};

/// The convex hull of a mesh (Qhull). If it has more corners than max_hull_corners, those that are outermost in evenly
/// spread directions remain. Throws MeshError if the points lie in a plane.
[[nodiscard]] ConvexHull convex_hull(const TriangleMesh& mesh);

/// The surface of a height field: two triangles for each cell of its grid, which face upwards. The shared edge runs
/// from the corner with the lowest x and y to the one with the highest.
[[nodiscard]] inline TriangleMesh surface_of(const HeightField& field) {
  TriangleMesh mesh;
  const auto steps = [](std::size_t number, std::size_t count, double half) {
    return half * (2.0 * static_cast<double>(number) / static_cast<double>(count - 1) - 1.0);
  };
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      mesh.vertices.emplace_back(steps(column, field.columns, field.half_x), steps(row, field.rows, field.half_y),
                                 field.heights[row * field.columns + column]);
    }
  }
  for (std::size_t row = 0; row + 1 < field.rows; ++row) {
    for (std::size_t column = 0; column + 1 < field.columns; ++column) {
      const auto corner = static_cast<std::uint32_t>(row * field.columns + column);
      const auto above = static_cast<std::uint32_t>(corner + field.columns);
      mesh.triangles.push_back({corner, corner + 1, above + 1});
      mesh.triangles.push_back({corner, above + 1, above});
    }
  }
  return mesh;
}

/// The solid within a closed mesh, at density 1. All in the frame of the mesh.
struct MeshSolid {
  double volume = 0.0;                                ///< m^3; negative if the triangles face inwards
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   ///< of volume
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre
};

/// Sums tetrahedra from the origin to each triangle (Eberly, "Polyhedral Mass Properties").
[[nodiscard]] inline MeshSolid solid_of(const TriangleMesh& mesh) {
  MeshSolid solid;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();  // integral of x x^T
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
    const Eigen::Vector3d& b = mesh.vertices[triangle[1]];
    const Eigen::Vector3d& c = mesh.vertices[triangle[2]];
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Eigen::Vector3d sum = a + b + c;
    solid.volume += volume;
    solid.center += volume / 4.0 * sum;
    products +=
        volume / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()).eval();
  }
  if (solid.volume == 0.0) {
    return solid;
  }
  solid.center /= solid.volume;
  products -= solid.volume * (solid.center * solid.center.transpose());
  solid.inertia = products.trace() * Eigen::Matrix3d::Identity() - products;
  return solid;
}

}  // namespace proleg::sim
