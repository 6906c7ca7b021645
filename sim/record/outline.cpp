#include "sim/record/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace proleg::sim {
namespace {

constexpr int curve_corners = 24;

/// Twice the area of the triangle; above 0 if it is counter-clockwise.
double turn(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// A. M. Andrew's monotone chain (1979).
Polyline convex_hull(Polyline points) {
  std::ranges::sort(points, [](Point a, Point b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  Polyline hull;
  const auto add_chain = [&hull](const auto& chain) {
    const std::size_t first = hull.size();
    for (const Point& point : chain) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();  // the other chain begins with it
  };
  add_chain(points);
  std::ranges::reverse(points);
  add_chain(points);
  return hull;
}

std::vector<Eigen::Vector3d> corners_of(const Geometry& solid) {
  const Eigen::Vector3d& e = solid.extents;
  std::vector<Eigen::Vector3d> corners;
  if (solid.shape == Shape::box) {
    for (const double x : {-e.x(), e.x()}) {
      for (const double y : {-e.y(), e.y()}) {
        for (const double z : {-e.z(), e.z()}) {
          corners.emplace_back(x, y, z);
        }
      }
    }
    return corners;
  }
  for (int i = 0; i < curve_corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / curve_corners;
    for (const double y : {-e.y(), e.y()}) {
      corners.emplace_back(e.x() * std::cos(angle), y, e.x() * std::sin(angle));
    }
  }
  return corners;
}

/// The part of a polygon on one side of a line: where distance() is not negative.
template <typename Distance>
Polyline cut(const Polyline& polygon, const Distance& distance) {
  Polyline result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point a = polygon[i];
    const Point b = polygon[(i + 1) % polygon.size()];
    const double at_a = distance(a);
    const double at_b = distance(b);
    if (at_a >= 0.0) {
      result.push_back(a);
    }
    if ((at_a >= 0.0) != (at_b >= 0.0)) {
      const double share = at_a / (at_a - at_b);
      result.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    }
  }
  return result;
}

}  // namespace

Polyline outline_of(const Geometry& solid, const Pose& link, const View& view) {
  const Pose pose = link * solid.pose;
  if (solid.shape == Shape::sphere) {
    const Point center = view.of(pose.position);
    Polyline circle;
    for (int i = 0; i < curve_corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / curve_corners;
      circle.push_back(
          {center.x + solid.extents.x() * std::cos(angle), center.y + solid.extents.x() * std::sin(angle)});
    }
    return circle;
  }
  Polyline points;
  for (const Eigen::Vector3d& corner : corners_of(solid)) {
    points.push_back(view.of(pose * corner));
  }
  return convex_hull(std::move(points));
}

Polyline clipped(const Polyline& polygon, Point low, Point high) {
  Polyline result = cut(polygon, [&](Point p) { return p.x - low.x; });
  result = cut(result, [&](Point p) { return high.x - p.x; });
  result = cut(result, [&](Point p) { return p.y - low.y; });
  return cut(result, [&](Point p) { return high.y - p.y; });
}

}  // namespace proleg::sim
