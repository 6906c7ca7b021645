// proleg new: writes the files of a new robot, obstacle or algorithm.

#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/new_files.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

void create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw BadInput("cannot create the folder " + folder.string() + ": " + error.message());
  }
}

struct NewOptions {
  std::string what;
  std::string kind;
  std::optional<std::string> joints;
  std::optional<std::string> axes;
  std::string out = "robot";
};

const sim::RobotKind& parse_kind(const std::string& word) {
  const sim::RobotKind* const kind = word.empty() ? &sim::robot_kinds().front() : sim::find_robot_kind(word);
  if (kind == nullptr) {
    std::vector<std::string> names;
    for (const sim::RobotKind& known : sim::robot_kinds()) {
      names.emplace_back(known.name);
    }
    throw InputError("--kind", 0, in_quotes(word), "one of " + listed(names));
  }
  return *kind;
}

std::uint32_t parse_joints(const std::string& word) {
  const std::optional<std::uint32_t> joints = parse_whole<std::uint32_t>(word);
  if (!joints || *joints == 0 || *joints > max_joints) {
    throw InputError("--joints", 0, in_quotes(word), "a whole number from 1 to " + std::to_string(max_joints));
  }
  return *joints;
}

/// The axis of each joint from the tail, from the repeated pattern.
std::string axes_of_joints(const std::string& pattern, std::uint32_t joints) {
  if (pattern.empty() || pattern.find_first_not_of("py") != std::string::npos) {
    throw InputError("--axes", 0, in_quotes(pattern), "letters p (pitch) and y (yaw), from the tail");
  }
  if (pattern.size() > joints) {
    throw InputError("--axes", 0,
                     std::to_string(pattern.size()) + " letters for a robot with --joints " + std::to_string(joints),
                     "at most one letter for each joint");
  }
  std::string axes;
  for (std::uint32_t joint = 0; joint < joints; ++joint) {
    axes += pattern[joint % pattern.size()];
  }
  return axes;
}

int write_robot(const NewOptions& options) {
  if (options.what != "robot") {
    throw BadInput("found " + in_quotes(options.what) + ", expected 'robot', 'obstacle' or 'algorithm'");
  }
  if (!options.joints && options.kind.empty()) {
    throw BadInput("--joints is required without --kind");
  }
  const sim::RobotKind& kind = parse_kind(options.kind);
  const std::uint32_t joints = options.joints ? parse_joints(*options.joints) : kind.joints;
  const std::string axes = options.axes.value_or(std::string(kind.axes.substr(0, joints)));
  const std::vector<sim::SourceFile> files = sim::new_scenario_files(kind, axes_of_joints(axes, joints));
  const std::filesystem::path folder = options.out;
  write_new_files(folder, files);
  std::cout << "run it:  proleg simulate " << shell_argument((folder / files.front().path).string()) << '\n';
  return exit_success;
}

}  // namespace

void proleg::tools::write_new_files(const std::filesystem::path& folder, std::span<const sim::SourceFile> files) {
  if (folder.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  for (const sim::SourceFile& file : files) {
    if (std::filesystem::exists(folder / file.path)) {
      throw BadInput((folder / file.path).string() +
                     ": found an existing file, expected none; --out FOLDER names another folder");
    }
  }
  for (const sim::SourceFile& file : files) {
    const std::filesystem::path path = folder / file.path;
    create_folder(path.parent_path());
    write_file(path, file.text);
    std::cout << "written  " << path.string() << '\n';
  }
}

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "obstacle") {
    return new_obstacle(argc - 1, argv + 1);
  }
  if (what == "algorithm") {
    return new_algorithm(argc - 1, argv + 1);
  }
  CommandLine command_line("proleg new",
                           "Writes the files of a new robot: a chain of joints, a gait that moves it, a flat floor and "
                           "the top-level file.\nThe modules are those of the shipped travelling_wave, or of another "
                           "kind of robot.\n'proleg new obstacle' writes an environment, 'proleg new algorithm' an "
                           "algorithm of your own: see their --help.");
  NewOptions options;
  command_line.add_option("WHAT", options.what, "what to write: robot, obstacle or algorithm")
      .required()
      .value_name("");
  std::string kinds = "kind of robot:";
  for (const sim::RobotKind& kind : sim::robot_kinds()) {
    kinds.append(&kind == &sim::robot_kinds().front() ? " " : "; ").append(kind.name).append(" (").append(kind.help);
    kinds += ")";
  }
  command_line.add_option("--kind", options.kind, kinds).value_name("KIND");
  command_line.add_option("--joints", options.joints, "number of joints, 1 to 64; by default that of the kind")
      .value_name("N");
  command_line
      .add_option("--axes", options.axes,
                  "p for a pitch joint, y for a yaw joint; the letters are repeated along the chain, from the tail; by "
                  "default those of the kind, or p")
      .value_name("LETTERS");
  command_line.add_option("--out", options.out, "folder for the files; none of them may exist")
      .value_name("FOLDER")
      .shows_default();
  return command_line.run(argc, argv, [&] { return write_robot(options); });
}
