#pragma once

#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/scenario/source_set.hpp"

namespace proleg::sim {

/// Reads an environment file: <Environment> with <physicsengine> (gravity, selfcollision) and KinBodies of static
/// bodies. A comment gives the start pose of the robot:
///   <!--Pose: ,X Y Z,A B C,-->
/// position in metres; then degrees: the robot is turned by A about the world's x axis, then by B about its y axis,
/// then by C about its z axis. Without the comment the robot starts at the origin. Adds to remarks and warnings.
[[nodiscard]] EnvironmentModel read_environment(const XmlDocument& document, SourceSet& sources,
                                                std::vector<std::string>& remarks, std::vector<std::string>& warnings);

}  // namespace proleg::sim
