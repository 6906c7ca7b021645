#include "sim/record/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace proleg::sim {
namespace {

constexpr int curve_corners = 24;
constexpr std::size_t section_columns = 160;

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
  if (solid.mesh) {
    return solid.mesh->vertices;
  }
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

MeshSection::MeshSection(const View& view, double middle, double half_thickness, double low, double high)
    : view_(view),
      middle_(middle),
      half_thickness_(half_thickness),
      low_(low),
      high_(high),
      tops_(section_columns, -INFINITY),
      bottoms_(section_columns, INFINITY) {}

double MeshSection::place_of(std::size_t column) const {
  return low_ + (high_ - low_) * static_cast<double>(column) / static_cast<double>(section_columns - 1);
}

void MeshSection::add_edge(Point from, Point to) {
  if (from.x > to.x) {
    std::swap(from, to);
  }
  if (to.x < low_ || from.x > high_) {
    return;
  }
  const double scale = static_cast<double>(section_columns - 1) / (high_ - low_);
  const double last = static_cast<double>(section_columns - 1);
  const auto first_column = static_cast<std::size_t>(std::clamp(std::ceil((from.x - low_) * scale), 0.0, last));
  const auto last_column = static_cast<std::size_t>(std::clamp(std::floor((to.x - low_) * scale), 0.0, last));
  for (std::size_t column = first_column; column <= last_column; ++column) {
    const double width = to.x - from.x;
    const double share = width > 0.0 ? std::clamp((place_of(column) - from.x) / width, 0.0, 1.0) : 0.0;
    const double height = from.y + share * (to.y - from.y);
    tops_[column] = std::max(tops_[column], height);
    bottoms_[column] = std::min(bottoms_[column], height);
  }
}

void MeshSection::add(const TriangleMesh& mesh, const Pose& pose) {
  const Eigen::Vector3d depth_axis = view_.right.cross(view_.up);
  struct Corner {
    Point place;
    double depth;  ///< from the middle of the slab
  };
  std::vector<Corner> part;
  std::vector<Corner> cut_part;
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    part.clear();
    for (const std::uint32_t corner : triangle) {
      const Eigen::Vector3d point = pose * mesh.vertices[corner];
      part.push_back({view_.of(point), depth_axis.dot(point) - middle_});
    }
    for (const double side : {1.0, -1.0}) {
      cut_part.clear();
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Corner& a = part[i];
        const Corner& b = part[(i + 1) % part.size()];
        const double at_a = half_thickness_ - side * a.depth;
        const double at_b = half_thickness_ - side * b.depth;
        if (at_a >= 0.0) {
          cut_part.push_back(a);
        }
        if ((at_a >= 0.0) != (at_b >= 0.0)) {
          const double share = at_a / (at_a - at_b);
          cut_part.push_back(
              {{a.place.x + share * (b.place.x - a.place.x), a.place.y + share * (b.place.y - a.place.y)},
               a.depth + share * (b.depth - a.depth)});
        }
      }
      part.swap(cut_part);
    }
    for (std::size_t i = 0; i < part.size(); ++i) {
      add_edge(part[i].place, part[(i + 1) % part.size()].place);
    }
  }
}

std::vector<Polyline> MeshSection::polygons() const {
  std::vector<Polyline> result;
  for (std::size_t first = 0; first < section_columns;) {
    if (tops_[first] < bottoms_[first]) {
      ++first;
      continue;
    }
    Polyline polygon;
    std::size_t end = first;
    for (; end < section_columns && tops_[end] >= bottoms_[end]; ++end) {
      polygon.push_back({place_of(end), tops_[end]});
    }
    for (std::size_t column = end; column-- > first;) {
      polygon.push_back({place_of(column), bottoms_[column]});
    }
    result.push_back(std::move(polygon));
    first = end;
  }
  return result;
}

Polyline clipped(const Polyline& polygon, Point low, Point high) {
  Polyline result = cut(polygon, [&](Point p) { return p.x - low.x; });
  result = cut(result, [&](Point p) { return high.x - p.x; });
  result = cut(result, [&](Point p) { return p.y - low.y; });
  return cut(result, [&](Point p) { return high.y - p.y; });
}

}  // namespace proleg::sim
