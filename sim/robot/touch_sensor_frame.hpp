#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// How the two touch sensors under a link lie in it: unit vectors in the frame of the link.
struct TouchSensorFrame {
  Eigen::Vector3d forward;   ///< along the link, to the head; zero if the robot has no other link
  Eigen::Vector3d down;      ///< out of the underside
  Eigen::Vector3d sideways;  ///< perpendicular to both

  /// Which sensor a contact with the environment presses, as World::link_contacts() describes them: 1 rear, 2 front, 0
  /// none. All in the frame of the link: the point from its centre of mass, the normal with either sign.
  [[nodiscard]] std::uint8_t pressed_by(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    constexpr double max_sine = 0.707;  // of 45 degrees of roll; beyond, the link lies on its flank
    if (point.dot(down) > 0.0 && std::abs(normal.dot(sideways)) < max_sine) {
      return point.dot(forward) < 0.0 ? 1U : 2U;
    }
    return 0U;
  }
};

/// The underside faces down (-z) in the robot's file at angles 0, or towards -y if the link is upright there.
[[nodiscard]] inline TouchSensorFrame touch_sensor_frame(const RobotModel& robot, std::size_t link) {
  const Pose& pose = robot.links[link].pose;
  const Eigen::Vector3d middle = pose * robot.links[link].mass.center;
  const Eigen::Vector3d front = link > 0 ? robot.joints[link - 1].anchor : middle;
  const Eigen::Vector3d rear = link < robot.joints.size() ? robot.joints[link].anchor : middle;
  const Eigen::Vector3d forward = (front - rear).stableNormalized();
  constexpr double upright = 0.99;
  const Eigen::Vector3d down = -(std::abs(forward.z()) < upright ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY());
  const Eigen::Vector3d underside = (down - down.dot(forward) * forward).normalized();
  const Eigen::Quaterniond to_link = pose.orientation.conjugate();
  return {to_link * forward, to_link * underside, to_link * forward.cross(underside)};
}

}  // namespace proleg::sim
