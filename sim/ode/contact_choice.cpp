#include "sim/ode/contact_choice.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace proleg::sim {
namespace {

double squared_distance(const dContactGeom& a, const dContactGeom& b) {
  const double x = a.pos[0] - b.pos[0];
  const double y = a.pos[1] - b.pos[1];
  const double z = a.pos[2] - b.pos[2];
  return x * x + y * y + z * z;
}

/// Removes points at the place of a deeper one, and returns the number of those left.
std::size_t merge(std::span<dContactGeom> points) {
  constexpr double same_place = 1e-10;  // m^2
  std::size_t count = 0;
  for (const dContactGeom& point : points) {
    const auto kept = points.first(count);
    const auto same = std::ranges::find_if(
        kept, [&](const dContactGeom& other) { return squared_distance(point, other) < same_place; });
    if (same == kept.end()) {
      points[count++] = point;
    } else if (point.depth > same->depth) {
      *same = point;
    }
  }
  return count;
}

}  // namespace

std::size_t choose_contacts(std::span<dContactGeom> points, std::size_t most) {
  points = points.first(merge(points));
  if (points.size() <= most) {
    return points.size();
  }
  std::array<double, max_mesh_points> distances{};  // distance from the nearest point that is kept
  distances.fill(std::numeric_limits<double>::max());
  auto next = static_cast<std::size_t>(std::ranges::max_element(points, {}, &dContactGeom::depth) - points.begin());
  for (std::size_t kept = 0; kept < most; ++kept) {
    std::swap(points[kept], points[next]);
    std::swap(distances[kept], distances[next]);
    next = kept + 1;
    for (std::size_t i = kept + 1; i < points.size(); ++i) {
      distances[i] = std::min(distances[i], squared_distance(points[i], points[kept]));
      next = distances[i] > distances[next] ? i : next;
    }
  }
  return most;
}

}  // namespace proleg::sim
