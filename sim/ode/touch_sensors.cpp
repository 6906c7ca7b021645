#include "sim/ode/touch_sensors.hpp"

#include <Eigen/Geometry>

namespace proleg::sim {

void TouchSensors::add_link(const RobotModel& robot, std::size_t link) {
  const Pose& pose = robot.links[link].pose;
  const Eigen::Vector3d middle = pose * robot.links[link].mass.center;
  const Eigen::Vector3d front = link > 0 ? robot.joints[link - 1].anchor : middle;
  const Eigen::Vector3d rear = link < robot.joints.size() ? robot.joints[link].anchor : middle;
  const Eigen::Vector3d forward = (front - rear).stableNormalized();  // zero if the robot has no other link
  constexpr double upright = 0.99;
  const Eigen::Vector3d down = -(std::abs(forward.z()) < upright ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY());
  const Eigen::Vector3d underside = (down - down.dot(forward) * forward).normalized();
  const Eigen::Quaterniond to_link = pose.orientation.conjugate();
  frames_.push_back({to_link * forward, to_link * underside, to_link * forward.cross(underside)});
  pressed_.push_back(0);
}

}  // namespace proleg::sim
