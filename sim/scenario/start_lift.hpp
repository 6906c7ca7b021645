#pragma once

// Where a robot starts that its files put inside the ground.

#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"

namespace proleg::sim {

/// Raises the start pose until no link of the robot, with all joint angles 0, is inside an object; what is above the
/// robot or beside it does not count. An object whose top is more than half a metre above the robot's lowest point is a
/// wall, unless it is under the start position (its bounds, seen from above, contain that): the robot is not lifted
/// onto it. A robot below everything is lifted onto the lowest of it. Never lowers the robot. A remark says how far it
/// was raised, and onto what.
void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks);

}  // namespace proleg::sim
