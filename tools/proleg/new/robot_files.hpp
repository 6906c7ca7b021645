#pragma once

// The files of a new robot, for `proleg new robot`.

#include <string>
#include <vector>

#include "tools/proleg/new/new_files.hpp"
#include "tools/proleg/new/robot_kinds.hpp"

namespace proleg::tools {

/// The files of a scenario: a robot with these joints, a gait that moves it, a flat floor. axes: for each joint from
/// the tail 'p' (pitch) or 'y' (yaw); 1 to 64 characters. The top-level file is the first one.
[[nodiscard]] std::vector<NewFile> robot_files(const RobotKind& kind, const std::string& axes);

}  // namespace proleg::tools
