#pragma once

// The environment of a robot, and where the robot starts in it.

#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::sim {

/// Reads an environment file: <Environment> with <physicsengine> (gravity, selfcollision) and KinBodies of static
/// bodies. A comment gives the start pose of the robot:
///   <!--Pose: ,X Y Z,A B C,-->
/// position in metres; then degrees: the robot is turned by A about the world's x axis, then by B about its y axis,
/// then by C about its z axis. Without the comment the robot starts at the origin. Adds to remarks and warnings.
[[nodiscard]] EnvironmentModel read_environment(const XmlDocument& document, SourceSet& sources,
                                                std::vector<std::string>& remarks, std::vector<std::string>& warnings);

/// Raises the start pose until no link of the robot, with all joint angles 0, is inside an object; what is above the
/// robot or beside it does not count. An object whose top is more than half a metre above the robot's lowest point is a
/// wall, unless it is under the start position (its bounds, seen from above, contain that): the robot is not lifted
/// onto it. A robot below everything is lifted onto the lowest of it. Never lowers the robot. A remark says how far it
/// was raised, and onto what.
void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks);

}  // namespace proleg::sim
