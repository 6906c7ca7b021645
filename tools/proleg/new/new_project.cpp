// proleg new project: a folder to work in.

#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/new_files.hpp"
#include "tools/proleg/new/robot_options.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// The text with each `key` as `value`.
std::string filled_in(std::string_view text, std::string_view key, std::string_view value) {
  std::string filled(text);
  for (std::size_t at = filled.find(key); at != std::string::npos; at = filled.find(key, at + value.size())) {
    filled.replace(at, key.size(), value);
  }
  return filled;
}

/// Throws BadInput if the folder has files, or is a file.
void require_empty(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
    throw BadInput(folder.string() + ": found " + (fs::is_directory(folder, error) ? "a folder with files" : "a file") +
                   ", expected a new or an empty folder");
  }
}

int write_project(const std::string& name, const RobotOptions& robot) {
  const fs::path folder = fs::path(name);
  require_empty(folder);
  std::vector<sim::SourceFile> files = robot_files(robot);
  const std::string joints(axes_of(robot).size(), '1');
  const std::string title = fs::absolute(folder / "").lexically_normal().parent_path().filename().string();
  files.push_back({"search.optimise.xml", filled_in(project_search_text(), "@JOINTS@", joints)});
  files.push_back({"README.md", filled_in(project_readme_text(), "@NAME@", one_line(title))});
  write_new_files(folder, files);
  std::cout << "open it:  proleg ui " << shell_argument(folder.string()) << '\n';
  return exit_success;
}

}  // namespace

int new_project(int argc, char** argv) {
  CommandLine command_line("proleg new project",
                           "Writes a folder to work in: a robot with a gait and a floor, as 'proleg new robot' writes "
                           "them, the file of a search for a better gait, and a README with the next commands.");
  std::string folder;
  RobotOptions robot;
  command_line.add_option("FOLDER", folder, "a new or an empty folder").required().value_name("");
  add_robot_options(command_line, robot);
  return command_line.run(argc, argv, [&] { return write_project(folder, robot); });
}

}  // namespace proleg::tools
