#include "sim/scenario/surface_under.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/bounds.hpp"

namespace proleg::sim {
namespace {

bool is_over(const Surface& surface, const std::optional<Surface>& other) {
  constexpr double rounding = 1e-9;  // m
  return !other || surface.height > other->height + rounding ||
         (surface.height > other->height - rounding && surface.faces_up);
}

/// Where the vertical through a point meets a triangle; nothing if the triangle is beside it or vertical.
std::optional<Surface> met_by_vertical(const std::array<Eigen::Vector3d, 3>& triangle, const Eigen::Vector3d& point,
                                       const StaticObject& object) {
  constexpr double vertical = 1e-6;  // part of the normal
  const Eigen::Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).stableNormalized();
  if (std::abs(normal.z()) < vertical) {
    return std::nullopt;
  }
  for (std::size_t corner = 0; corner < triangle.size(); ++corner) {
    const Eigen::Vector3d side = triangle[(corner + 1) % triangle.size()] - triangle[corner];
    const Eigen::Vector3d to_point = point - triangle[corner];
    if ((side.x() * to_point.y() - side.y() * to_point.x()) * normal.z() < 0.0) {
      return std::nullopt;
    }
  }
  const double above = normal.dot(point - triangle[0]) / normal.z();
  return Surface{point.z() - above, normal.z() > 0.0, &object};
}

}  // namespace

std::optional<Surface> surface_under(const Eigen::Vector3d& point, const EnvironmentModel& environment) {
  std::optional<Surface> first;
  const auto add = [&](const std::optional<Surface>& surface) {
    if (surface && surface->height <= point.z() && is_over(*surface, first)) {
      first = surface;
    }
  };
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& geometry : object.geometries) {
      const Bounds bounds = bounds_of(geometry, object.pose);
      if (!contains_from_above(bounds, point)) {
        continue;
      }
      if (!geometry.mesh) {
        add(Surface{bounds.highest.z(), true, &object});
        continue;
      }
      const Pose pose = object.pose * geometry.pose;
      for (const auto& [a, b, c] : geometry.mesh->triangles) {
        const std::vector<Eigen::Vector3d>& vertices = geometry.mesh->vertices;
        add(met_by_vertical({pose * vertices[a], pose * vertices[b], pose * vertices[c]}, point, object));
      }
    }
  }
  return first;
}

}  // namespace proleg::sim
