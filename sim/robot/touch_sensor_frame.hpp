#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// How the two touch sensors under a link lie in it: unit vectors in the frame of the link.
struct TouchSensorFrame {
  Eigen::Vector3d forward;   ///< along the link, to the head; zero if the robot has no other link
  Eigen::Vector3d down;      ///< out of the underside
  Eigen::Vector3d sideways;  ///< perpendicular to both
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
