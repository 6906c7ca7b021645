#pragma once

// The kinds of robots that `proleg new robot --kind` writes.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/proleg/new/new_files.hpp"

namespace proleg::tools {

/// A kind of modular robot: its modules, and how they are put together.
struct RobotKind {
  std::string_view name;     ///< in --kind
  std::string_view help;     ///< a line
  std::string_view axes;     ///< of its joints from the tail, repeated: p (pitch), y (yaw)
  unsigned joints;           ///< if the user states none
  std::size_t module_mm;     ///< between two joints
  std::string_view torque;   ///< Nm
  std::string_view speed;    ///< rad/s
  std::string_view comment;  ///< which values are published and which are chosen
};

/// The first is the shipped caterpillar.
[[nodiscard]] std::span<const RobotKind> robot_kinds();
/// Null: there is no such kind.
[[nodiscard]] const RobotKind* find_robot_kind(std::string_view name);

/// The files of the modules of a kind: modules/tail.kinbody.xml, segment, head, and what they name.
[[nodiscard]] std::vector<NewFile> module_files(const RobotKind& kind);

}  // namespace proleg::tools
