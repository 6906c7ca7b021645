#pragma once

// The ground as a picture shows it: heights of the static world, and sections through it.

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sim/environment/environment_model.hpp"
#include "sim/robot/bounds.hpp"

namespace proleg::tools {

/// The heights of what does not move.
class GroundHeights {
 public:
  /// environment: must outlive this.
  explicit GroundHeights(const sim::EnvironmentModel& environment);

  /// The highest surface at a place, in m; nothing where there is none.
  [[nodiscard]] std::optional<double> at(const Eigen::Vector2d& place) const;

 private:
  struct Solid {
    const sim::Geometry* geometry;
    sim::Pose pose;  ///< in the world
    sim::Bounds bounds;
    std::vector<Eigen::Vector3d> vertices;  ///< of a mesh, in the world
    /// Numbers of the triangles of a mesh in each of some equal ranges of x.
    std::vector<std::vector<std::size_t>> triangles;

    [[nodiscard]] std::size_t range_of(double x) const;
  };
  std::vector<Solid> solids_;
};

/// A point of a section: how far it is along the line, and its height; both in m.
using SectionPoint = Eigen::Vector2d;

/// The section of the ground over a line from `from` along the unit vector `along`, `length` m long. Steps are upright.
/// tolerance: m, by which the section may differ from the ground. missing: the height where there is no ground.
[[nodiscard]] std::vector<SectionPoint> ground_section(const GroundHeights& ground, const Eigen::Vector2d& from,
                                                       const Eigen::Vector2d& along, double length, double tolerance,
                                                       double missing);

}  // namespace proleg::tools
