#pragma once

#include <optional>

#include <Eigen/Core>

#include "sim/environment/environment_model.hpp"

namespace proleg::sim {

/// A place on a static object.
struct Surface {
  double height = 0.0;  ///< m, in the world
  bool faces_up = true;
  const StaticObject* object = nullptr;
};

/// The first surface under a point (m, in the world). Shapes without a mesh count as the boxes around them, which face
/// up. Of two surfaces at one height, as in a sheet with two sides, it is one that faces up.
[[nodiscard]] std::optional<Surface> surface_under(const Eigen::Vector3d& point, const EnvironmentModel& environment);

}  // namespace proleg::sim
