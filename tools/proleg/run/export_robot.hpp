#pragma once

// proleg export --urdf, --mjcf: the robot of a scenario for other simulators.

#include <string>

namespace proleg::tools {

struct RobotExportOptions {
  std::string source;  ///< scenario, the name of a shipped one, or a recording
  std::string urdf;    ///< file; "-": standard output; empty: none
  std::string mjcf;    ///< the same
};

/// Writes the files, and prints their names and what they have lost. Returns the exit status. Throws InputError for a
/// scenario that cannot be read and for a file that cannot be written.
[[nodiscard]] int export_robot(const RobotExportOptions& options);

}  // namespace proleg::tools
