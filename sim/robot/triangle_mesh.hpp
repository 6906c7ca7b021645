#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace proleg::sim {

/// A surface of triangles.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< m, in the frame of the shape
  /// Numbers of vertices, counter-clockwise as seen from outside.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Red, green and blue of each vertex, 0 to 1; empty: the mesh has no colours.
  std::vector<Eigen::Vector3f> colours;
};

/// Heights over a level grid, row by row. Columns follow x, rows follow y; the first height is at the lowest x and y.
struct HeightField {
  std::size_t columns = 0;      ///< at least 2
  std::size_t rows = 0;         ///< at least 2
  double half_x = 0.0;          ///< m, from the middle of the grid to its first and last column
  double half_y = 0.0;          ///< m, from the middle of the grid to its first and last row
  std::vector<double> heights;  ///< m
};

}  // namespace proleg::sim
