#pragma once

// The options of a new robot: what kind of chain it is.

#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

struct RobotOptions {
  std::string kind;
  std::optional<std::string> joints;
  std::optional<std::string> axes;
};

void add_robot_options(CommandLine& command_line, RobotOptions& options);

/// The axis of each joint from the tail: p or y. Throws InputError.
[[nodiscard]] std::string axes_of(const RobotOptions& options);

/// The files of the robot with its gait and its floor; the top-level file is the first one. Throws InputError.
[[nodiscard]] std::vector<sim::SourceFile> robot_files(const RobotOptions& options);

}  // namespace proleg::tools
