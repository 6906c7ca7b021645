#include "sim/mesh/mesh_geometry.hpp"

#include <libqhull_r/libqhull_r.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "sim/mesh/mesh_checks.hpp"

namespace proleg::sim {
namespace {

using Points = std::vector<Eigen::Vector3d>;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A run of Qhull. Its C++ interface is not C++20.
class QhullRun {
 public:
  /// coordinates: x, y, z of each point; they must outlive the run.
  explicit QhullRun(std::vector<double>& coordinates) : silence_(std::fopen("/dev/null", "w")) {
    qh_zero(&state_, silence_.get());
    std::string options = "qhull Qt Pp";  // triangles; no hints on precision
    status_ = qh_new_qhull(&state_, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), 0, options.data(),
                           nullptr, silence_.get());
  }
  ~QhullRun() {
    qh_freeqhull(&state_, 0);
    int blocks = 0;
    int bytes = 0;
    qh_memfreeshort(&state_, &blocks, &bytes);
  }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;

  [[nodiscard]] bool has_failed() const { return status_ != 0; }

  /// Calls use(corners) for each side: numbers of points.
  template <typename Use>
  void for_each_side(const Use& use) {
    std::vector<std::uint32_t> corners;
    for (const facetT* side = state_.facet_list; side != nullptr && side->next != nullptr; side = side->next) {
      corners.clear();
      for (const setelemT* element = side->vertices->e; element->p != nullptr; ++element) {
        const auto* const corner = static_cast<const vertexT*>(element->p);
        corners.push_back(static_cast<std::uint32_t>(qh_pointid(&state_, corner->point)));
      }
      use(corners);
    }
  }

 private:
  std::unique_ptr<std::FILE, CloseFile> silence_;
  qhT state_{};
  int status_ = 0;
};

/// Triangles of the hull; numbers of points.
std::vector<std::array<std::uint32_t, 3>> hull_triangles(const Points& points) {
  std::vector<double> coordinates;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    coordinates.insert(coordinates.end(), point.data(), point.data() + 3);
    middle += point / static_cast<double>(points.size());
  }
  QhullRun run(coordinates);
  if (run.has_failed()) {
    throw MeshError("a flat mesh, which has no volume", "a solid, or a thickness");
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  run.for_each_side([&](const std::vector<std::uint32_t>& corners) {
    if (corners.size() != 3) {
      throw MeshError("a mesh whose convex hull has a side of " + std::to_string(corners.size()) + " corners",
                      "a solid of which a hull of triangles can be made");
    }
    std::array<std::uint32_t, 3> triangle{corners[0], corners[1], corners[2]};
    const Eigen::Vector3d& a = points[triangle[0]];
    const Eigen::Vector3d normal = (points[triangle[1]] - a).cross(points[triangle[2]] - a);
    if (normal.dot(a - middle) < 0.0) {
      std::swap(triangle[1], triangle[2]);
    }
    triangles.push_back(triangle);
  });
  return triangles;
}

/// The points that a set of triangles uses, and the triangles with their new numbers.
TriangleMesh compacted(const Points& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  TriangleMesh mesh;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (const std::array<std::uint32_t, 3>& triangle : triangles) {
    std::array<std::uint32_t, 3> copy{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto [known, is_new] =
          numbers.try_emplace(triangle[corner], static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(points[triangle[corner]]);
      }
      copy[corner] = known->second;
    }
    mesh.triangles.push_back(copy);
  }
  return mesh;
}

/// The points that are outermost in evenly spread directions (a Fibonacci spiral).
Points outermost(const Points& points) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < max_hull_corners; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(max_hull_corners);
    const double angle = golden_angle * static_cast<double>(i);
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
    const auto farthest = std::ranges::max_element(points, {}, [&](const auto& point) { return direction.dot(point); });
    chosen.insert(static_cast<std::size_t>(farthest - points.begin()));
  }
  Points result;
  for (const std::size_t i : chosen) {
    result.push_back(points[i]);
  }
  return result;
}

double farthest_outside(const Points& points, const TriangleMesh& hull) {
  double farthest = 0.0;
  for (const std::array<std::uint32_t, 3>& triangle : hull.triangles) {
    const Eigen::Vector3d& a = hull.vertices[triangle[0]];
    const Eigen::Vector3d normal =
        (hull.vertices[triangle[1]] - a).cross(hull.vertices[triangle[2]] - a).stableNormalized();
    for (const Eigen::Vector3d& point : points) {
      farthest = std::max(farthest, normal.dot(point - a));
    }
  }
  return farthest;
}

}  // namespace

ConvexHull convex_hull(const TriangleMesh& mesh) {
  ConvexHull hull{compacted(mesh.vertices, hull_triangles(mesh.vertices)), 0.0};
  if (hull.mesh.vertices.size() > max_hull_corners) {
    const Points all = std::move(hull.mesh.vertices);
    const Points few = outermost(all);
    hull.mesh = compacted(few, hull_triangles(few));
    hull.deviation = farthest_outside(all, hull.mesh);
  }
  return hull;
}

}  // namespace proleg::sim
