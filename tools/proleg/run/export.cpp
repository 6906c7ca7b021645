// proleg export: writes a recording as a table for other programs, as a data file of the thesis, or as a page that
// plays it; writes a data file as a table, and the robot of a scenario for other simulators.

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/data_file/data_file.hpp"
#include "sim/data_file/data_file_writer.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/document/recording_document.hpp"
#include "tools/proleg/document/recording_page.hpp"
#include "tools/proleg/run/export_robot.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

using Write = std::function<void(std::string_view)>;

struct Options {
  std::string recording;
  std::string out;
  bool tsv = true;  // without --html
  bool html = false;
  bool thesis = false;
  bool json = false;
};

/// The data to export, and their form.
struct Export {
  std::filesystem::path file;
  PlannedOutput output;
  std::function<void(const Write&)> write_with;
};

/// The length of an exported run, as far as it is known.
struct Length {
  std::uint64_t ticks = 0;
  double seconds = 0.0;
};

Export table_of(const sim::Recording& recording, const std::filesystem::path& file) {
  return {file, {"--out", file, "table", starts_with("tick\t")}, [&recording](const Write& write) {
            sim::write_tsv(recording, write);
          }};
}

Export data_file_of(const sim::Recording& recording, const std::filesystem::path& file) {
  // Not within the braces: if a later part of nested braces throws, GCC 12 destroys the parts before it twice.
  std::optional<sim::Scenario> scenario = sim::recorded_scenario(recording);
  return {file,
          {"--out", file, "data file", starts_with("<dataroot>")},
          [&recording, scenario = std::move(scenario)](const Write& write) {
            sim::write_data_file(recording, scenario, write);
          }};
}

/// Reads and checks all inputs of the page before a file is written.
Export page_of(const sim::Recording& recording, const std::filesystem::path& file) {
  const auto player = std::make_shared<const PlayerPage>(folder_of_page("player", "player.html") / "player.html");
  const auto scenario = std::make_shared<const sim::Scenario>(scenario_of(recording));
  return {file,
          {"--out", file, "page of a recording", starts_with(PlayerPage::first_text)},
          [&recording, player, scenario](const Write& write) {
            RunProgress progress("proleg export", recording.time_s(recording.last_tick()));
            write_html(recording, *scenario, *player, write,
                       [&](std::uint32_t tick) { progress.show(recording.time_s(tick)); });
          }};
}

std::string shown_size(std::uint64_t bytes) {
  constexpr double megabyte = 1e6;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f MB", static_cast<double>(bytes) / megabyte);
  return text.data();
}

void print_result(const Options& options, const Length& length, const std::string& file, std::uint64_t bytes) {
  std::string text;
  if (options.json) {
    text = Json{{"file", file}, {"bytes", bytes}, {"ticks", length.ticks}, {"seconds", length.seconds}}.text() + "\n";
  } else {
    text = file + "\n";
    if (options.html) {
      std::array<char, 64> figures{};
      std::snprintf(figures.data(), figures.size(), ", %llu ticks, %g s\n",
                    static_cast<unsigned long long>(length.ticks), length.seconds);
      text += shown_size(bytes) + figures.data();
    }
  }
  Output standard_output;
  standard_output.write(text);
  standard_output.finish();
}

/// remark: prints a remark if the command is not refused. length: called when all is written.
int write_export(const Options& options, const Export& planned, const std::function<void()>& remark,
                 const std::function<Length()>& length) {
  const bool to_standard_output = options.out == "-";
  if (!to_standard_output) {
    const std::array outputs{planned.output};
    check_outputs(outputs);
  }
  remark();
  try {
    std::optional<Output> output;
    if (to_standard_output) {
      output.emplace();
    } else {
      output.emplace(planned.file);
    }
    std::uint64_t bytes = 0;
    planned.write_with([&](std::string_view text) {
      output->write(text);
      bytes += text.size();
    });
    output->finish();
    const Length written = length();
    if (!to_standard_output) {
      print_result(options, written, planned.file.string(), bytes);
    }
  } catch (const ReaderGone&) {
    return exit_failed;  // `head` closes the pipe like this, which needs no message
  }
  return exit_success;
}

int export_data_file(const CommandLine& command_line, const Options& options) {
  if (options.html || options.thesis) {
    throw InputError(options.recording, 0, "an XML file",
                     std::string("a recording, because of ") + (options.html ? "--html" : "--thesis"));
  }
  sim::DataFile data(options.recording);
  const std::filesystem::path file = options.out.empty()
                                         ? std::filesystem::path(options.recording).replace_extension(".tsv")
                                         : std::filesystem::path(options.out);
  const Export planned{
      file, {"--out", file, "table", starts_with("tick\t")}, [&](const Write& write) { data.write_table(write); }};
  const auto length = [&] {
    if (const std::string remark = data.remark_on_cut(); !remark.empty()) {
      print_warning(command_line.name(), remark);
    }
    return Length{data.rows(), data.last_time_s()};
  };
  return write_export(
      options, planned, [] {}, length);
}

Export planned_export(const Options& options, const sim::Recording& recording) {
  const std::string extension = options.html ? ".html" : options.thesis ? ".data.xml" : ".tsv";
  const std::filesystem::path file =
      options.out.empty() ? beside_recording(options.recording, extension) : std::filesystem::path(options.out);
  if (options.html) {
    return page_of(recording, file);
  }
  return options.thesis ? data_file_of(recording, file) : table_of(recording, file);
}

int export_recording(const CommandLine& command_line, const Options& options) {
  if (options.out == "-" && options.json) {
    throw BadInput("--json: found --out -, expected a file: both go to standard output");
  }
  if (sim::is_xml_file(options.recording)) {
    return export_data_file(command_line, options);
  }
  const sim::Recording recording(options.recording);
  const Export planned = planned_export(options, recording);
  const auto remark = [&] {
    if (const std::string text = sim::remark_on_unfinished_run(recording); !text.empty()) {
      print_warning(command_line.name(), text);
    }
  };
  return write_export(options, planned, remark, [&] {
    const std::uint64_t ticks = std::uint64_t{recording.last_tick()} - recording.first_tick() + 1;
    return Length{ticks, static_cast<double>(ticks) * 1e-6 * recording.tick_period_us()};
  });
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg export",
      "Writes a recording of 'proleg simulate --record' as a table: a header line, then a line for each tick; as a "
      "data\n"
      "file of the 2013 thesis (XML); or as a page that plays it in a browser, without a server. Such a data file, "
      "whole\n"
      "or cut, can be written as a table, too. Prints the name of the file.\n"
      "With --urdf or --mjcf it writes the robot of a scenario (or of a recording) for other simulators, and prints "
      "what\n"
      "they have not ('lost').\n"
      "Columns: tick; time_s; for each joint setpoint_deg, servo_us, angle_deg, torque_Nm and current_mA (means over "
      "the\n"
      "tick) and its internal values; for each link x_m, y_m, z_m, its orientation qw, qx, qy, qz, contact_rear,\n"
      "contact_front, contact_N. Joint and link names follow the dot (setpoint_deg.J1).");
  Options options;
  RobotExportOptions robot;
  command_line
      .add_option("RUN", options.recording, "the recording, or a data file; with --urdf or --mjcf also a scenario")
      .required()
      .value_name("");
  command_line.add_flag("--tsv", options.tsv, "write tab-separated values, as without this option");
  command_line
      .add_flag("--html", options.html, "write a page that plays the recording in 3D, one file; prints its size too")
      .excludes("--tsv");
  command_line.add_flag("--thesis", options.thesis, "write a data file of the thesis (listing B.8; docs/recordings.md)")
      .excludes("--tsv")
      .excludes("--html");
  for (const auto& [name, file, help] :
       {std::tuple("--urdf", &robot.urdf,
                   "write the robot as URDF, for ROS, Gazebo and Webots, with its meshes in a folder beside it; - for\n"
                   "standard output"),
        std::tuple("--mjcf", &robot.mjcf, "write robot and world as a model of MuJoCo; - for standard output")}) {
    command_line.add_option(name, *file, help)
        .value_name("FILE")
        .excludes("--tsv")
        .excludes("--html")
        .excludes("--thesis");
  }
  command_line
      .add_option(
          "--out", options.out,
          "the file; by default run.tsv, run.data.xml or run.html for run.proleg, run.1.tsv for run.1; - for standard\n"
          "output")
      .value_name("FILE")
      .excludes("--urdf")
      .excludes("--mjcf");
  command_line.add_flag("--json", options.json, "print one JSON object").excludes("--urdf").excludes("--mjcf");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] {
    if (robot.urdf.empty() && robot.mjcf.empty()) {
      return export_recording(command_line, options);
    }
    robot.source = options.recording;
    return export_robot(robot);
  });
}
