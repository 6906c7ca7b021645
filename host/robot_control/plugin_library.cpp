#include "host/robot_control/plugin_library.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>

#include "shared/computer/child_process/trial.hpp"

namespace proleg::host {
namespace {

/// The reason why dlopen() or dlsym() failed, without the path, which the message already has.
std::string loader_error(const std::string& path) {
  const char* const text = dlerror();
  std::string error = text == nullptr ? "unknown reason" : text;
  if (error.starts_with(path + ": ")) {
    error.erase(0, path.size() + 2);
  }
  return error;
}

bool has_all_functions(const proleg_robot_control_plugin& plugin) {
  return plugin.open != nullptr && plugin.close != nullptr && plugin.describe != nullptr && plugin.connect != nullptr &&
         plugin.disconnect != nullptr && plugin.enable_servos != nullptr && plugin.send_command != nullptr &&
         plugin.send_command_by_value != nullptr && plugin.request_all_information != nullptr &&
         plugin.request_information != nullptr && plugin.test != nullptr && plugin.reset_command_buffer != nullptr;
}

void check(const proleg_robot_control_plugin* functions, const std::string& where) {
  if (functions == nullptr) {
    throw RobotControlError(where + ": found no plug-in behind " + PROLEG_ROBOT_CONTROL_ENTRY +
                            "(), expected its functions; ask the author of the plug-in");
  }
  // Only the first member is the same in all versions.
  if (functions->abi_version != PROLEG_ROBOT_CONTROL_ABI_VERSION) {
    throw RobotControlError(where + ": found version " + std::to_string(functions->abi_version) +
                            " of the plug-in interface, expected " + std::to_string(PROLEG_ROBOT_CONTROL_ABI_VERSION) +
                            "; compile the plug-in with robot_control.h of this Proleg");
  }
  if (functions->size < sizeof(proleg_robot_control_plugin) || functions->name == nullptr ||
      !has_all_functions(*functions)) {
    throw RobotControlError(where + ": found a plug-in with missing functions, expected all of robot_control.h; " +
                            "compile the plug-in again");
  }
}

/// Loads a library in this process.
Plugin load(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::shared_ptr<void> library(dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* handle) {
    if (handle != nullptr) {
      dlclose(handle);
    }
  });
  if (!library) {
    throw RobotControlError(name + ": found no plug-in that can be loaded (" + loader_error(name) +
                            "), expected a shared library for this computer");
  }
  using Entry = const proleg_robot_control_plugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library.get(), PROLEG_ROBOT_CONTROL_ENTRY));
  if (entry == nullptr) {
    throw RobotControlError(name + ": found no function " + PROLEG_ROBOT_CONTROL_ENTRY +
                            ", expected that of a plug-in; is this another library?");
  }
  Plugin plugin = check_plugin(entry(), name);
  plugin.functions = {library, plugin.functions.get()};
  return plugin;
}

}  // namespace

std::filesystem::path find_plugin(const std::string& name, const std::filesystem::path& robot_folder,
                                  const std::vector<std::filesystem::path>& folders) {
  if (name.find('/') != std::string::npos) {
    return std::filesystem::absolute(robot_folder / name);
  }
  const std::string file = "proleg-" + name + ".so";
  std::vector<std::string> searched;
  for (const std::filesystem::path& folder : folders) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(folder / file, ignored)) {
      return std::filesystem::absolute(folder / file);
    }
    searched.push_back(folder.string());
  }
  throw RobotControlError("found no " + file + " in " + listed(searched) + ", expected the plug-in " + in_quotes(name) +
                          "; install it, set PROLEG_PLUGINS to its folder, or write its path in the robot's file");
}

std::vector<std::filesystem::path> plugin_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* const folder = std::getenv("PROLEG_PLUGINS"); folder != nullptr && *folder != '\0') {
    folders.emplace_back(folder);
  }
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path top = program.parent_path().parent_path();
  folders.push_back(top / "lib");
  folders.push_back(top / "lib" / "proleg");
  return folders;
}

Plugin load_plugin(const std::filesystem::path& path) {
  // A damaged library ends the program that loads it.
  const Trial trial = try_in_child([&]() -> std::string {
    try {
      static_cast<void>(load(path));
      return "";
    } catch (const RobotControlError& error) {
      return error.what();
    }
  });
  if (!trial.has_returned) {
    throw RobotControlError(path.string() + ": found a library that, while it is loaded, " + trial.text +
                            ", expected a plug-in that can be loaded; compile or install the plug-in again");
  }
  if (!trial.text.empty()) {
    throw RobotControlError(trial.text);
  }
  return load(path);
}

Plugin check_plugin(const proleg_robot_control_plugin* functions, const std::string& where) {
  check(functions, where);
  return {shortened(one_line(functions->name)), {std::shared_ptr<void>(), functions}};
}

}  // namespace proleg::host
