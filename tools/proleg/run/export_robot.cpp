#include "tools/proleg/run/export_robot.hpp"

#include <filesystem>
#include <iostream>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/data_file/data_file.hpp"
#include "sim/mjcf/mjcf.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/urdf/urdf_export.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/document/recording_document.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view standard_output = "-";

sim::Scenario read_source(const std::string& source) {
  const std::string file = scenario_file(source);
  refuse_folder(file, scenario_extension);
  if (fs::is_regular_file(file) && !sim::is_xml_file(file)) {
    return scenario_of(sim::Recording(file));
  }
  sim::DiskFiles files;
  return sim::read_scenario(file, files);
}

/// A file that is planned, with its bytes.
struct PlannedFile {
  PlannedOutput output;
  std::string bytes;
};

/// All files of an export begin with a text that says so.
PlannedFile planned(const std::string& option, const fs::path& path, const std::string& kind, std::string bytes) {
  const bool is_xml = bytes.starts_with("<!--");
  return {{option, path, kind, starts_with((is_xml ? "<!-- " : "") + std::string(sim::export_mark))}, std::move(bytes)};
}

void write(const std::vector<PlannedFile>& files, const std::vector<std::string>& lost) {
  std::vector<PlannedOutput> outputs;
  for (const PlannedFile& file : files) {
    if (const fs::path folder = file.output.path.parent_path(); !folder.empty()) {
      std::error_code error;  // check_outputs() reports it
      fs::create_directories(folder, error);
    }
    outputs.push_back(file.output);
  }
  check_outputs(outputs);
  for (const PlannedFile& file : files) {
    write_file(file.output.path, file.bytes);
    std::cout << file.output.path.string() << '\n';
  }
  for (const std::string& text : lost) {
    std::cout << "lost     " << one_line(text) << '\n';
  }
}

}  // namespace

int export_robot(const RobotExportOptions& options) {
  const sim::Scenario scenario = read_source(options.source);
  std::vector<PlannedFile> files;
  std::vector<std::string> lost;
  if (options.urdf == standard_output && options.mjcf == standard_output) {
    throw InputError("--mjcf", 0, "standard output, to which --urdf goes", "another file");
  }
  if (!options.urdf.empty()) {
    const fs::path path = options.urdf;
    const sim::UrdfExport robot = sim::export_urdf(scenario.robot, path.stem().string() + "_meshes");
    if (path == standard_output) {
      if (!robot.meshes.empty()) {
        throw InputError("--urdf", 0, "standard output for a robot with meshes",
                         "a file: meshes are written beside it");
      }
      std::cout << robot.text;
    } else {
      files.push_back(planned("--urdf", path, "URDF file", robot.text));
      for (const sim::SourceFile& mesh : robot.meshes) {
        files.push_back(planned("--urdf", path.parent_path() / mesh.path, "mesh", sim::bytes_of_source(mesh.text)));
      }
      lost.insert(lost.end(), robot.lost.begin(), robot.lost.end());
    }
  }
  if (!options.mjcf.empty()) {
    const sim::mujoco::MjcfExport model =
        sim::mujoco::export_mjcf(scenario.robot, scenario.environment, scenario.step_s);
    if (options.mjcf == standard_output) {
      std::cout << model.text;
    } else {
      files.push_back(planned("--mjcf", options.mjcf, "MJCF file", model.text));
      lost.insert(lost.end(), model.lost.begin(), model.lost.end());
    }
  }
  const bool is_listed = options.urdf != standard_output && options.mjcf != standard_output;
  write(files, is_listed ? lost : std::vector<std::string>{});
  return exit_success;
}

}  // namespace proleg::tools
