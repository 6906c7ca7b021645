#pragma once

// The kinds of modular robots that Proleg knows, and the files of their modules.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

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

/// The files of the modules of a kind: modules/tail.kinbody.xml, segment, head, and the files that they name. The names
/// of their bodies are "Tail", "Seg" and "Head".
[[nodiscard]] std::vector<SourceFile> module_files(const RobotKind& kind);

}  // namespace proleg::sim
