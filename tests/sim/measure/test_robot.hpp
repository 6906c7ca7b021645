#pragma once

#include <cstddef>
#include <string>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Links of one length along y, the head foremost, each with its origin in its middle, pitch joints between them. The
/// end links are as long as the others.
inline RobotModel straight_robot(std::size_t links, double link_length = 0.072, double link_mass = 0.1) {
  RobotModel robot;
  const Eigen::Vector3d half_sides(0.02, link_length / 2, 0.02);
  const Eigen::Vector3d squares = 4 * half_sides.cwiseProduct(half_sides);
  for (std::size_t i = 0; i < links; ++i) {
    Link link;
    link.name = std::to_string(i);
    link.pose.position = {0, -link_length * static_cast<double>(i), 0};
    link.mass.mass = link_mass;
    link.mass.inertia =
        (link_mass / 12 *
         Eigen::Vector3d(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y()))
            .asDiagonal();
    Geometry geometry;
    geometry.extents = half_sides;
    link.geometries.push_back(geometry);
    robot.links.push_back(link);
  }
  for (std::size_t i = 0; i + 1 < links; ++i) {
    Joint joint;
    joint.anchor = {0, -link_length * (static_cast<double>(i) + 0.5), 0};
    joint.lower_limit = -1.5;
    joint.upper_limit = 1.5;
    joint.max_torque = 2.0;
    joint.max_speed = 4.5;
    robot.joints.push_back(joint);
  }
  return robot;
}

}  // namespace proleg::sim
