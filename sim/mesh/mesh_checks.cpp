#include "sim/mesh/mesh_checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

/// Twice the area.
double area_of(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
  return (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).norm();
}

Eigen::Vector3d size_of(const TriangleMesh& mesh) {
  Eigen::Vector3d lowest = mesh.vertices.front();
  Eigen::Vector3d highest = lowest;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    lowest = lowest.cwiseMin(vertex);
    highest = highest.cwiseMax(vertex);
  }
  return highest - lowest;
}

/// Below this the area is rounding, for a mesh of this size.
double least_area(const TriangleMesh& mesh) {
  constexpr double relative = 1e-12;
  return relative * size_of(mesh).squaredNorm();
}

std::string point_text(const Eigen::Vector3d& point) {
  return number_text(point.x()) + ' ' + number_text(point.y()) + ' ' + number_text(point.z());
}

}  // namespace

void require_size(const TriangleMesh& mesh, double least, double most) {
  const Eigen::Vector3d size = size_of(mesh);
  const double longest = size.maxCoeff();
  if (longest >= least && longest <= most) {
    return;
  }
  if (!(longest > 0.0)) {
    throw MeshError("a mesh whose points are all at one place",
                    "a longest side from " + number_text(least) + " to " + number_text(most) + " m");
  }
  const char* const hint = longest > most ? "a file in millimetres needs the scale 0.001"
                                          : "a file in kilometres, or scaled twice, needs the scale 1000";
  throw MeshError(
      "a mesh of " + number_text(size.x()) + " x " + number_text(size.y()) + " x " + number_text(size.z()) + " m",
      "a longest side from " + number_text(least) + " to " + number_text(most) + " m; " + hint);
}

void require_area(const TriangleMesh& mesh) {
  const double least = least_area(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!(area_of(mesh, mesh.triangles[i]) > least)) {
      throw MeshError("triangle " + std::to_string(i + 1) + ", at " + point_text(mesh.vertices[mesh.triangles[i][0]]) +
                          ", without area",
                      "triangles whose corners are not on one line");
    }
  }
}

void require_closed(const TriangleMesh& mesh) {
  std::map<std::tuple<double, double, double>, std::uint32_t> places;
  std::vector<std::uint32_t> place_of;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    // + 0.0 makes the two zeros one.
    const auto [known, is_new] = places.try_emplace({vertex.x() + 0.0, vertex.y() + 0.0, vertex.z() + 0.0},
                                                    static_cast<std::uint32_t>(places.size()));
    place_of.push_back(known->second);
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      ++edges[{place_of[triangle[corner]], place_of[triangle[(corner + 1) % 3]]}];
    }
  }
  std::size_t open = 0;
  std::optional<Eigen::Vector3d> first;
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = place_of[triangle[corner]];
      const std::uint32_t to = place_of[triangle[(corner + 1) % 3]];
      const auto opposite = edges.find({to, from});
      if (edges[{from, to}] != 1 || opposite == edges.end() || opposite->second != 1) {
        ++open;
        first = first.value_or(mesh.vertices[triangle[corner]]);
      }
    }
  }
  if (open > 0) {
    throw MeshError("a mesh with holes: " + std::to_string(open) + " of " + std::to_string(3 * mesh.triangles.size()) +
                        " edges belong to no second triangle or to more, the first near " + point_text(*first),
                    "a closed surface, or open=\"1\" for a sheet");
  }
}

TriangleMesh without_slivers(TriangleMesh mesh) {
  const double least = least_area(mesh);
  std::erase_if(mesh.triangles, [&](const auto& triangle) { return !(area_of(mesh, triangle) > least); });
  if (mesh.triangles.empty()) {
    throw MeshError("a mesh whose triangles have no area", "triangles whose corners are not on one line");
  }
  return mesh;
}

}  // namespace proleg::sim
