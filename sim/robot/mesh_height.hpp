#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Height of the highest point of a mesh over a level rectangle, in the world; nothing if no triangle is above or below
/// it. pose: of the mesh in the world. low, high: corners of the rectangle, which may be a point.
[[nodiscard]] inline std::optional<double> highest_over(const TriangleMesh& mesh, const Pose& pose,
                                                        const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  std::optional<double> top;
  std::vector<Eigen::Vector3d> part;
  std::vector<Eigen::Vector3d> cut;
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    part.clear();
    for (const std::uint32_t corner : triangle) {
      part.push_back(pose * mesh.vertices[corner]);
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
