#pragma once

#include <Eigen/Geometry>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

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
