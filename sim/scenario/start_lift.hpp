#pragma once

// Where a robot starts that its files put inside the ground.

#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"

namespace proleg::sim {

/// Raises the start pose until the robot, with all joint angles 0, rests on the highest of the objects below its start
/// position (whose bounds, seen from above, contain that position), and no link is inside an object. An object whose
/// top is more than half a metre above the robot's lowest point is a wall: the robot is not lifted onto it unless it
/// starts under its bounds. Never lowers the robot. A remark says how far it was raised, and onto what.
void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks);

}  // namespace proleg::sim
