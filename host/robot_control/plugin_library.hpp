#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot_control_abi/robot_control.h"
#include "shared/computer/text/text.hpp"

namespace proleg::host {

/// A robot or its plug-in failed. what(): one line, with what to do.
class RobotControlError : public std::runtime_error {
 public:
  explicit RobotControlError(const std::string& text) : std::runtime_error(one_line(text)) {}
};

/// The robot's file is wrong: it names a plug-in that cannot be loaded, or parameters that the plug-in rejects. what()
/// begins with FILE:LINE. As an InputError, it is bad input for a program.
class RobotFileError : public RobotControlError {
 public:
  using RobotControlError::RobotControlError;
};

/// The path of the plug-in with that name. A name with a slash is a path, relative to `robot_folder`. Any other name
/// NAME is the file proleg-NAME.so in the first one of `folders` that has it. Throws RobotControlError.
[[nodiscard]] std::filesystem::path find_plugin(const std::string& name, const std::filesystem::path& robot_folder,
                                                const std::vector<std::filesystem::path>& folders);

/// The folders of the plug-ins of this installation: the folder in the environment variable PROLEG_PLUGINS, then lib/
/// and lib/proleg/ beside the folder of the running program.
[[nodiscard]] std::vector<std::filesystem::path> plugin_folders();

/// A loaded plug-in. The library stays loaded until the last copy of `functions` is destroyed.
struct Plugin {
  std::string name;
  std::shared_ptr<const proleg_robot_control_plugin> functions;
};

/// Loads a library and checks its interface, in a child first: a damaged library can end the program that loads it.
/// Throws RobotControlError if the file does not load, if it exports no entry, if its version differs, or if a function
/// is missing.
[[nodiscard]] Plugin load_plugin(const std::filesystem::path& path);

/// Checks the interface of a plug-in that is part of the program. `where` names it in errors.
[[nodiscard]] Plugin check_plugin(const proleg_robot_control_plugin* functions, const std::string& where);

}  // namespace proleg::host
