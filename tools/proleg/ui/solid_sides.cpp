#include "tools/proleg/ui/solid_sides.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

namespace proleg::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t most_corners = 8;  // of an outline

double area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return std::abs((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()));
}

/// Leaves out the corners that change the outline least (Visvalingam and Whyatt 1993).
void thin(std::vector<Vector2d>& corners) {
  while (corners.size() > most_corners) {
    std::size_t least = 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const double size =
          area(corners[(i + corners.size() - 1) % corners.size()], corners[i], corners[(i + 1) % corners.size()]);
      if (size < smallest) {
        smallest = size;
        least = i;
      }
    }
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

}  // namespace

std::vector<Side> sides_of(const sim::Geometry& geometry, const sim::Pose& link, const Camera& camera, bool is_simple) {
  std::vector<Side> sides;
  if (geometry.shape != sim::Shape::box || is_simple) {
    Side side;
    for (const sim::Point& point : sim::outline_of(geometry, link, camera.view())) {
      side.corners.emplace_back(point.x, point.y);
    }
    thin(side.corners);
    sides.push_back(std::move(side));
    return sides;
  }
  const sim::Pose pose = link * geometry.pose;
  const Vector3d sun = (Vector3d::UnitZ() - 0.35 * camera.away - 0.25 * camera.right).normalized();
  for (const int axis : {0, 1, 2}) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d normal = pose.orientation * (sign * Vector3d::Unit(axis));
      constexpr double edge_on = 0.02;
      if (normal.dot(camera.toward) < edge_on) {
        continue;
      }
      Side side;
      side.light = std::clamp((1.0 + normal.dot(sun)) / 2.0, 0.0, 1.0);
      constexpr std::array<std::array<double, 2>, 4> signs{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      for (const auto& [one, other] : signs) {
        Vector3d corner = sign * Vector3d::Unit(axis) * geometry.extents[axis];
        corner[(axis + 1) % 3] = one * geometry.extents[(axis + 1) % 3];
        corner[(axis + 2) % 3] = other * geometry.extents[(axis + 2) % 3];
        side.corners.push_back(camera.of(pose * corner));
      }
      sides.push_back(std::move(side));
    }
  }
  return sides;
}

}  // namespace proleg::tools
