#pragma once

// What a picture shows of a solid.

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "sim/record/outline.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::tools {

/// Looks at the world from above its side, without perspective.
struct Camera {
  Eigen::Vector3d right;   ///< level
  Eigen::Vector3d away;    ///< level
  Eigen::Vector3d up;      ///< of the picture
  Eigen::Vector3d toward;  ///< to the eye

  Camera(double azimuth, double elevation)
      : right(std::cos(azimuth), std::sin(azimuth), 0.0),
        away(-std::sin(azimuth), std::cos(azimuth), 0.0),
        up(std::cos(elevation) * Eigen::Vector3d::UnitZ() + std::sin(elevation) * away),
        toward(std::sin(elevation) * Eigen::Vector3d::UnitZ() - std::cos(elevation) * away) {}

  [[nodiscard]] sim::View view() const { return {right, up}; }
  [[nodiscard]] Eigen::Vector2d of(const Eigen::Vector3d& point) const { return {right.dot(point), up.dot(point)}; }
  /// A point of the world from its places along right and away, and its height.
  [[nodiscard]] Eigen::Vector3d point(double along, double aside, double z) const {
    return along * right + aside * away + z * Eigen::Vector3d::UnitZ();
  }
};

/// A side of a solid that is seen.
struct Side {
  std::vector<Eigen::Vector2d> corners;
  double light = 0.5;  ///< 0 to 1
};

/// The sides of a box that are seen; of any other solid, and of any if is_simple, its outline, of at most 8 corners.
/// link: pose of the frame that holds it.
[[nodiscard]] std::vector<Side> sides_of(const sim::Geometry& geometry, const sim::Pose& link, const Camera& camera,
                                         bool is_simple);

}  // namespace proleg::tools
