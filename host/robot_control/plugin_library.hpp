#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/robot_control_abi/robot_control.h"

namespace proleg::host {

/// Where the plug-in with that name is. A name with a slash is a path, relative to `robot_folder`. Any other name NAME
/// is the file proleg-NAME.so in one of `folders`, the first that has it. Throws RobotControlError.
[[nodiscard]] std::filesystem::path find_plugin(const std::string& name, const std::filesystem::path& robot_folder,
                                                const std::vector<std::filesystem::path>& folders);

/// The folders of the plug-ins of this installation: that of the environment variable PROLEG_PLUGINS, then lib/ and
/// lib/proleg/ beside the folder of the running program.
[[nodiscard]] std::vector<std::filesystem::path> plugin_folders();

/// A plug-in, loaded. The library stays loaded until the last copy of `functions` ends.
struct Plugin {
  std::string name;
  std::shared_ptr<const proleg_robot_control_plugin> functions;
};

/// Loads a library and checks its interface. Throws RobotControlError: the file does not load, it exports no entry, its
/// version differs, a function is missing.
[[nodiscard]] Plugin load_plugin(const std::filesystem::path& path);

/// The same checks for a plug-in that is part of the program. `where` names it in errors.
[[nodiscard]] Plugin check_plugin(const proleg_robot_control_plugin* functions, const std::string& where);

}  // namespace proleg::host
