// proleg new: writes the files of a new robot, project, obstacle or algorithm.

#include <filesystem>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/new_files.hpp"
#include "tools/proleg/new/robot_options.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct NewOptions {
  std::string what;
  RobotOptions robot;
  std::string out = "robot";
};

int write_robot(const NewOptions& options) {
  if (options.what != "robot") {
    throw BadInput("found " + in_quotes(options.what) + ", expected 'robot', 'project', 'obstacle' or 'algorithm'");
  }
  if (!options.robot.joints && options.robot.kind.empty()) {
    throw BadInput("--joints is required without --kind");
  }
  const std::vector<sim::SourceFile> files = robot_files(options.robot);
  const std::filesystem::path folder = options.out;
  write_new_files(folder, files);
  std::cout << "run it:  proleg simulate " << shell_argument((folder / files.front().path).string()) << '\n';
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "obstacle") {
    return new_obstacle(argc - 1, argv + 1);
  }
  if (what == "project") {
    return new_project(argc - 1, argv + 1);
  }
  if (what == "algorithm") {
    return new_algorithm(argc - 1, argv + 1);
  }
  CommandLine command_line("proleg new",
                           "Writes the files of a new robot: a chain of joints, a gait that moves it, a flat floor and "
                           "the top-level file.\nThe modules are those of the shipped travelling_wave, or of another "
                           "kind of robot.\n'proleg new project' writes a folder to work in, 'proleg new obstacle' an "
                           "environment, 'proleg new algorithm' an algorithm of your own: see their --help.");
  NewOptions options;
  command_line.add_option("WHAT", options.what, "what to write: robot, project, obstacle or algorithm")
      .required()
      .value_name("");
  add_robot_options(command_line, options.robot);
  command_line.add_option("--out", options.out, "folder for the files; none of them may exist")
      .value_name("FOLDER")
      .shows_default();
  return command_line.run(argc, argv, [&] { return write_robot(options); });
}
