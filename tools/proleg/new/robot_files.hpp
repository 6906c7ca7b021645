#pragma once

// The files of a new robot, for `proleg new robot`, and the kinds of robots that its option --kind names.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/proleg/new/new_files.hpp"

namespace proleg::tools {

/// A kind of modular robot: its modules and their connection.
struct RobotKind {
  std::string_view name;     ///< name in --kind
  std::string_view help;     ///< one line for --help
  std::string_view axes;     ///< axes of its joints from the tail, repeated: p (pitch), y (yaw)
  unsigned joints;           ///< default number of joints
  std::size_t module_mm;     ///< distance between two joints, mm
  std::string_view torque;   ///< Nm
  std::string_view speed;    ///< rad/s
  std::string_view comment;  ///< comment with the published and the chosen values
};

/// All kinds; the first is the shipped caterpillar.
[[nodiscard]] std::span<const RobotKind> robot_kinds();
/// Finds a kind by its name; null if none has it.
[[nodiscard]] const RobotKind* find_robot_kind(std::string_view name);

/// The files of the modules of a kind: modules/tail.kinbody.xml, segment, head, and the files that they name.
[[nodiscard]] std::vector<NewFile> module_files(const RobotKind& kind);

/// The files of a scenario: a robot with these joints, a gait that moves it, a flat floor. axes: for each joint from
/// the tail 'p' (pitch) or 'y' (yaw); 1 to 64 characters. The top-level file is the first one.
[[nodiscard]] std::vector<NewFile> robot_files(const RobotKind& kind, const std::string& axes);

}  // namespace proleg::tools
