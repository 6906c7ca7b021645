// proleg import: makes a scenario of a robot in URDF.

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/urdf/urdf_import.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/new_files.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct Options {
  std::string robot;
  std::string out;
  std::vector<std::string> packages;
  std::optional<double> density;
};

sim::UrdfImportOptions import_options(const Options& options) {
  sim::UrdfImportOptions result;
  for (const std::string& package : options.packages) {
    const std::size_t sign = package.find('=');
    if (sign == 0 || sign == std::string::npos || sign + 1 == package.size()) {
      throw InputError("--package", 0, in_quotes(package), "NAME=FOLDER");
    }
    result.packages[package.substr(0, sign)] = package.substr(sign + 1);
  }
  if (options.density) {
    constexpr double least = 1.0;
    constexpr double most = 25'000.0;
    if (!(*options.density >= least && *options.density <= most)) {
      throw InputError("--density", 0, number_text(*options.density), "1 to 25000 kg/m^3");
    }
    result.density = *options.density;
  }
  return result;
}

int write_import(const CommandLine& command_line, const Options& options) {
  const std::filesystem::path robot = options.robot;
  const std::filesystem::path folder = options.out.empty() ? robot.stem() : std::filesystem::path(options.out);
  sim::DiskFiles files;
  const sim::UrdfImport import = sim::import_urdf(robot, files, import_options(options));
  write_new_files(folder, import.files);
  for (const std::string& text : import.notes) {
    std::cout << "note     " << one_line(text) << '\n';
  }
  for (const std::string& text : import.lost) {
    std::cout << "lost     " << one_line(text) << '\n';
  }
  std::cout << "run it:  proleg simulate " << shell_argument((folder / import.files.front().path).string()) << '\n';
  for (const std::string& text : import.warnings) {
    print_warning(command_line.name(), text);
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg import",
                           "Makes a scenario of a robot in URDF, the format of ROS: a robot file with its meshes, a "
                           "first gait, a flat floor\n"
                           "and the top-level file. The robot must be a chain of 1 to 64 revolute or continuous "
                           "joints; links at fixed joints\n"
                           "become one. Prints what was chosen because the file does not say it ('note'), and what the "
                           "file has and Proleg has\n"
                           "not ('lost').");
  Options options;
  command_line.add_option("ROBOT", options.robot, "the URDF file").required().value_name("");
  command_line
      .add_option("--package", options.packages,
                  "folder of the package that package://NAME/ means; may be given several times. Without it: a folder\n"
                  "of that name, or with a package.xml that has it, beside or above the URDF file")
      .value_name("NAME=FOLDER");
  command_line
      .add_option("--density", options.density, "of links without <inertial>, in kg/m^3, 1 to 25000; 1000 by default")
      .value_name("X");
  command_line
      .add_option("--out", options.out,
                  "folder for the files, of which none may exist; by default that of the file's name: arm for arm.urdf")
      .value_name("FOLDER");
  return command_line.run(argc, argv, [&] { return write_import(command_line, options); });
}
