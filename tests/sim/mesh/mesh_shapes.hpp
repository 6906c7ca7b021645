#pragma once

// Meshes whose volume and inertia are known.

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// A closed box of 0.2 x 0.4 x 0.6, as text of an OFF file.
inline constexpr const char* box_off = R"(OFF
8 6 0
-0.1 -0.2 -0.3
-0.1 -0.2 0.3
-0.1 0.2 -0.3
-0.1 0.2 0.3
0.1 -0.2 -0.3
0.1 -0.2 0.3
0.1 0.2 -0.3
0.1 0.2 0.3
4 0 1 3 2
4 4 6 7 5
4 0 4 5 1
4 2 3 7 6
4 0 2 6 4
4 1 5 7 3
)";

/// A closed box. half_sides in m; middle: of the box.
inline TriangleMesh box_mesh(const Eigen::Vector3d& half_sides,
                             const Eigen::Vector3d& middle = Eigen::Vector3d::Zero()) {
  TriangleMesh mesh;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        mesh.vertices.emplace_back(middle + Eigen::Vector3d(x, y, z).cwiseProduct(half_sides));
      }
    }
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& side : sides) {
    mesh.triangles.push_back({side[0], side[1], side[2]});
    mesh.triangles.push_back({side[0], side[2], side[3]});
  }
  return mesh;
}

/// A flat sheet of square cells, at height 0, that faces upwards.
inline TriangleMesh sheet(std::uint32_t cells, double side) {
  TriangleMesh mesh;
  const std::uint32_t corners = cells + 1;
  for (std::uint32_t row = 0; row < corners; ++row) {
    for (std::uint32_t column = 0; column < corners; ++column) {
      mesh.vertices.emplace_back(side * (column - cells / 2.0), side * (row - cells / 2.0), 0.0);
    }
  }
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t corner = row * corners + column;
      mesh.triangles.push_back({corner, corner + 1, corner + corners + 1});
      mesh.triangles.push_back({corner, corner + corners + 1, corner + corners});
    }
  }
  return mesh;
}

/// Points of a sphere.
inline TriangleMesh sphere_points(double radius, int rings, int points) {
  TriangleMesh mesh;
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (int i = 0; i < points; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / points;
      mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(angle), radius * std::sin(polar) * std::sin(angle),
                                 radius * std::cos(polar));
    }
  }
  return mesh;
}

}  // namespace proleg::sim
