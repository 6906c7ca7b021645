#pragma once

// The files of a new scenario: a robot, a gait that moves it, a flat floor.

#include <string>
#include <vector>

#include "sim/authoring/robot_kinds.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// axes: for each joint from the tail 'p' (pitch) or 'y' (yaw); 1 to 64 characters. The names of the files are relative
/// to their folder; the top-level file is the first one.
[[nodiscard]] std::vector<SourceFile> new_scenario_files(const RobotKind& kind, const std::string& axes);

}  // namespace proleg::sim
