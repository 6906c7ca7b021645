#include "host/robot_control/plugin_library.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

std::filesystem::path built(const std::string& name) {
  return std::filesystem::path(PROLEG_TEST_PLUGINS) / (name + ".so");
}

std::string load_error(const std::filesystem::path& path) {
  const std::string message = message_of<RobotControlError>([&] { static_cast<void>(load_plugin(path)); });
  return message.starts_with(path.string()) ? message.substr(path.string().size()) : message;
}

TEST(PluginLibrary, LoadsAPlugin) {
  const Plugin plugin = load_plugin(built("proleg-example"));
  EXPECT_EQ(plugin.name, "example");
  EXPECT_EQ(plugin.functions->abi_version, PROLEG_ROBOT_CONTROL_ABI_VERSION);
}

TEST(PluginLibrary, AFileThatDoesNotLoadIsNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "text.so") << "no library";
  const std::string message = load_error(folder / "text.so");
  EXPECT_EQ(message.find(": found no plug-in that can be loaded ("), 0U) << message;
  EXPECT_NE(message.find("), expected a shared library for this computer"), std::string::npos) << message;
  EXPECT_NE(load_error(folder / "missing.so").find("No such file"), std::string::npos);
}

TEST(PluginLibrary, ADamagedFileIsNamedAndDoesNotEndTheProgram) {
  const TemporaryFolder folder;
  const std::filesystem::path damaged = folder / "damaged.so";
  const std::string good = file_contents(built("proleg-example"));
  // What is behind the first quarter is for a debugger.
  for (std::size_t size = 64; size < good.size() / 4; size += good.size() / 100) {
    std::ofstream(damaged, std::ios::binary) << good.substr(0, size);
    EXPECT_EQ(load_error(damaged).find(": found "), 0U) << size << " of " << good.size() << " bytes";
  }
}

TEST(PluginLibrary, ALibraryThatIsNoPluginIsNamed) {
  EXPECT_EQ(load_error(built("no_entry")),
            ": found no function proleg_robot_control_plugin_v1, expected that of a plug-in; is this another library?");
  EXPECT_EQ(load_error(built("null")),
            ": found no plug-in behind proleg_robot_control_plugin_v1(), expected its functions; ask the author of the "
            "plug-in");
  EXPECT_EQ(load_error(built("wrong_version")),
            ": found version 2 of the plug-in interface, expected 1; compile the plug-in with robot_control.h of this "
            "Proleg");
  EXPECT_EQ(load_error(built("without_functions")),
            ": found a plug-in with missing functions, expected all of robot_control.h; compile the plug-in again");
}

TEST(PluginLibrary, ANameIsAFileInTheFirstFolderThatHasIt) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a");
  std::filesystem::create_directory(folder / "b");
  std::ofstream(folder.path() / "b" / "proleg-x.so");
  EXPECT_EQ(find_plugin("x", "/robots", {folder / "a", folder / "b"}), folder.path() / "b" / "proleg-x.so");
  std::ofstream(folder.path() / "a" / "proleg-x.so");
  EXPECT_EQ(find_plugin("x", "/robots", {folder / "a", folder / "b"}), folder.path() / "a" / "proleg-x.so");
  EXPECT_EQ(find_plugin("plugins/x.so", "/robots", {}), "/robots/plugins/x.so");
  EXPECT_EQ(
      message_of<RobotControlError>([] {
        static_cast<void>(find_plugin("x", "/robots", {"/p", "/q"}));
      }),
      "found no proleg-x.so in /p, /q, expected the plug-in 'x'; install it, set PROLEG_PLUGINS to its folder, or "
      "write its path in the robot's file");
}

TEST(PluginLibrary, TheShippedPluginIsFoundBesideTheProgram) {
  const Plugin plugin = load_plugin(find_plugin("dynamixel", "/robots", plugin_folders()));
  EXPECT_EQ(plugin.name, "dynamixel");
}

}  // namespace
}  // namespace proleg::host
