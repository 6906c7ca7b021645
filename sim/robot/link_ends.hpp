#pragma once

#include <cstddef>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// The ends of a link, in the robot's frame at angles 0.
struct LinkEnds {
  Eigen::Vector3d rear;
  Eigen::Vector3d front;
};

/// A link ends at its joints. An end link reaches as far beyond its centre of mass as its joint is from it.
inline LinkEnds link_ends(const RobotModel& robot, std::size_t link) {
  const Eigen::Vector3d center = robot.links[link].pose * robot.links[link].mass.center;
  LinkEnds ends{center, center};
  if (link < robot.joints.size()) {
    ends.rear = robot.joints[link].anchor;
  }
  if (link > 0) {
    ends.front = robot.joints[link - 1].anchor;
  }
  if (link == 0) {
    ends.front = 2.0 * center - ends.rear;
  }
  if (link == robot.joints.size()) {
    ends.rear = 2.0 * center - ends.front;
  }
  return ends;
}

}  // namespace proleg::sim
