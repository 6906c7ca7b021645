#pragma once

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

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

}  // namespace proleg::sim
