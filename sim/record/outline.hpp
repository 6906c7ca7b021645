#pragma once

#include <Eigen/Core>

#include "sim/record/svg.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// A direction from which solids are seen without perspective. Points of the view are in metres, y upwards.
struct View {
  Eigen::Vector3d right;  ///< unit vectors in the world, perpendicular to each other
  Eigen::Vector3d up;

  [[nodiscard]] Point of(const Eigen::Vector3d& point) const { return {right.dot(point), up.dot(point)}; }
};

/// The outline of a solid: a convex polygon. link: pose of the frame that holds it. Curves have 24 corners.
[[nodiscard]] Polyline outline_of(const Geometry& solid, const Pose& link, const View& view);

/// The part of a convex polygon within a rectangle; empty if there is none.
[[nodiscard]] Polyline clipped(const Polyline& polygon, Point low, Point high);

}  // namespace proleg::sim
