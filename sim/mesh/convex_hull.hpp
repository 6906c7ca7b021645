#pragma once

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

}  // namespace proleg::sim
