#include "tools/proleg/ui/ground_section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>

namespace proleg::tools {
namespace {

constexpr std::size_t mesh_ranges = 32;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The part of a line, from + t * direction, that is in a solid.
struct Part {
  double begin = -infinity;
  double end = infinity;

  [[nodiscard]] bool is_there() const { return begin <= end; }
  void cut(Part other) {
    begin = std::max(begin, other.begin);
    end = std::min(end, other.end);
  }
};

/// Between two parallel planes, at -half and half of a coordinate.
Part part_between(double from, double direction, double half) {
  if (std::abs(direction) < 1e-12) {
    return std::abs(from) <= half ? Part{} : Part{infinity, -infinity};
  }
  const double one = (-half - from) / direction;
  const double other = (half - from) / direction;
  return {std::min(one, other), std::max(one, other)};
}

/// Where a t^2 + 2 b t + c <= 0; a not negative.
Part part_of_square(double a, double b, double c) {
  if (a < 1e-12) {
    return c <= 0.0 ? Part{} : Part{infinity, -infinity};
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) {
    return {infinity, -infinity};
  }
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

/// Where a vertical line enters a box, sphere or cylinder from above: its height there.
std::optional<double> top_of(const sim::Geometry& geometry, const sim::Pose& pose, const Eigen::Vector3d& above) {
  const Eigen::Quaterniond back = pose.orientation.conjugate();
  const Eigen::Vector3d from = back * (above - pose.position);
  const Eigen::Vector3d down = back * -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& extents = geometry.extents;
  Part part;
  switch (geometry.shape) {
    case sim::Shape::sphere:
      part = part_of_square(1.0, from.dot(down), from.squaredNorm() - extents.x() * extents.x());
      break;
    case sim::Shape::cylinder:
      part = part_between(from.y(), down.y(), extents.y());
      part.cut(part_of_square(down.x() * down.x() + down.z() * down.z(), from.x() * down.x() + from.z() * down.z(),
                              from.x() * from.x() + from.z() * from.z() - extents.x() * extents.x()));
      break;
    default:
      for (const int axis : {0, 1, 2}) {
        part.cut(part_between(from[axis], down[axis], extents[axis]));
      }
  }
  return part.is_there() ? std::optional(above.z() - part.begin) : std::nullopt;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The height of a triangle over a place.
std::optional<double> height_of(const std::array<Eigen::Vector3d, 3>& corners, const Eigen::Vector2d& place) {
  const Eigen::Vector2d a = corners[0].head<2>() - place;
  const Eigen::Vector2d b = corners[1].head<2>() - place;
  const Eigen::Vector2d c = corners[2].head<2>() - place;
  const std::array<double, 3> areas{cross(b, c), cross(c, a), cross(a, b)};
  const double area = areas[0] + areas[1] + areas[2];
  const bool is_over = std::ranges::all_of(areas, [](double part) { return part >= 0.0; }) ||
                       std::ranges::all_of(areas, [](double part) { return part <= 0.0; });
  if (!is_over || std::abs(area) < 1e-12) {
    return std::nullopt;
  }
  return (areas[0] * corners[0].z() + areas[1] * corners[1].z() + areas[2] * corners[2].z()) / area;
}

/// Between two points with different heights: the edge of a step there, if there is one.
void add_step(const std::function<double(double)>& height, SectionPoint low, SectionPoint high, double least,
              std::vector<SectionPoint>& points) {
  constexpr int halvings = 8;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low.x() + high.x()) / 2.0;
    const double at_middle = height(middle);
    const bool is_low = std::abs(at_middle - low.y()) < std::abs(at_middle - high.y());
    (is_low ? low : high) = {middle, at_middle};
  }
  if (std::abs(low.y() - high.y()) > least) {
    points.push_back(low);
    points.push_back({low.x(), high.y()});
  }
}

/// Appends the points between two that a line must have to stay within the tolerance (Douglas and Peucker 1973).
void add_needed(std::span<const SectionPoint> points, double tolerance, std::vector<SectionPoint>& needed) {
  if (points.size() < 3) {
    return;
  }
  const Eigen::Vector2d way = points.back() - points.front();
  std::size_t farthest = 0;
  double most = tolerance;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Eigen::Vector2d to_point = points[i] - points.front();
    const double length = way.norm();
    const double distance = length > 0.0 ? std::abs(cross(way, to_point)) / length : to_point.norm();
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  if (farthest > 0) {
    add_needed(points.first(farthest + 1), tolerance, needed);
    needed.push_back(points[farthest]);
    add_needed(points.subspan(farthest), tolerance, needed);
  }
}

}  // namespace

std::size_t GroundHeights::Solid::range_of(double x) const {
  const double size = bounds.highest.x() - bounds.lowest.x();
  const double share = size > 0.0 ? (x - bounds.lowest.x()) / size : 0.0;
  return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (mesh_ranges - 1));
}

GroundHeights::GroundHeights(const sim::EnvironmentModel& environment) {
  for (const sim::StaticObject& object : environment.objects) {
    for (const sim::Geometry& geometry : object.geometries) {
      Solid solid{&geometry, object.pose * geometry.pose, sim::bounds_of(geometry, object.pose), {}, {}};
      if (geometry.mesh) {
        for (const Eigen::Vector3d& vertex : geometry.mesh->vertices) {
          solid.vertices.push_back(solid.pose * vertex);
        }
        solid.triangles.resize(mesh_ranges);
        for (std::size_t number = 0; number < geometry.mesh->triangles.size(); ++number) {
          const auto& [a, b, c] = geometry.mesh->triangles[number];
          const auto [low, high] = std::minmax({solid.vertices[a].x(), solid.vertices[b].x(), solid.vertices[c].x()});
          for (std::size_t range = solid.range_of(low); range <= solid.range_of(high); ++range) {
            solid.triangles[range].push_back(number);
          }
        }
      }
      solids_.push_back(std::move(solid));
    }
  }
}

std::optional<double> GroundHeights::at(const Eigen::Vector2d& place) const {
  std::optional<double> highest;
  const auto add = [&](std::optional<double> height) {
    if (height && (!highest || *height > *highest)) {
      highest = height;
    }
  };
  for (const Solid& solid : solids_) {
    const Eigen::Vector3d above{place.x(), place.y(), solid.bounds.highest.z() + 1.0};
    if (!sim::contains_from_above(solid.bounds, above)) {
      continue;
    }
    if (!solid.geometry->mesh) {
      add(top_of(*solid.geometry, solid.pose, above));
      continue;
    }
    for (const std::size_t number : solid.triangles[solid.range_of(place.x())]) {
      const auto& [a, b, c] = solid.geometry->mesh->triangles[number];
      add(height_of({solid.vertices[a], solid.vertices[b], solid.vertices[c]}, place));
    }
  }
  return highest;
}

std::vector<SectionPoint> ground_section(const GroundHeights& ground, const Eigen::Vector2d& from,
                                         const Eigen::Vector2d& along, double length, double tolerance,
                                         double missing) {
  constexpr int intervals = 64;
  const auto height = [&](double way) { return ground.at(from + way * along).value_or(missing); };
  std::vector<SectionPoint> points;
  for (int i = 0; i <= intervals; ++i) {
    const double way = length * i / intervals;
    const SectionPoint next{way, height(way)};
    if (!points.empty() && std::abs(next.y() - points.back().y()) > 2.0 * tolerance) {
      add_step(height, points.back(), next, 2.0 * tolerance, points);
    }
    points.push_back(next);
  }
  std::vector<SectionPoint> needed{points.front()};
  add_needed(points, tolerance, needed);
  needed.push_back(points.back());
  return needed;
}

}  // namespace proleg::tools
