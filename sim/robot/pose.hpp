#pragma once

#include <Eigen/Geometry>

namespace proleg::sim {

/// Position and orientation of a frame.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();

  /// The pose in the outer frame of something that has the pose `inner` in this frame.
  [[nodiscard]] Pose operator*(const Pose& inner) const {
    return {position + orientation * inner.position, orientation * inner.orientation};
  }
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return position + orientation * point; }
  [[nodiscard]] Pose inverse() const {
    const Eigen::Quaterniond back = orientation.conjugate();
    return {-(back * position), back};
  }
};

}  // namespace proleg::sim
