// proleg plot: draws a recording, or columns of it or of a data file, as a picture.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/data_file/data_file.hpp"
#include "sim/record/figure.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/series.hpp"
#include "sim/record/tsv.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scratch_folder.hpp"

using namespace proleg;
using namespace proleg::tools;

namespace {

/// An SVG picture as PNG, with two pixels for each of its own, made by librsvg's rsvg-convert. Throws BadInput that
/// names the Debian package if this is not installed, and std::runtime_error if it fails.
std::string png_of(const std::string& svg) {
  const ScratchFolder folder;
  write_file(folder.path() / "picture.svg", svg);
  const ProgramResult result =
      run_program({"rsvg-convert", "--format", "png", "--zoom", "2", "--output", "picture.png", "picture.svg"},
                  folder.path().string());
  if (!result.was_found) {
    throw BadInput(
        "--png: found no program rsvg-convert, expected it in PATH (on Debian: apt install librsvg2-bin); without "
        "--png "
        "the picture is SVG");
  }
  std::ifstream file(folder.path() / "picture.png", std::ios::binary);
  std::ostringstream png;
  png << file.rdbuf();
  if (result.status != 0 || png.str().empty()) {
    throw std::runtime_error("rsvg-convert ended with status " + std::to_string(result.status) +
                             " and made no picture");
  }
  return png.str();
}

struct Options {
  std::string recording;
  std::string out;
  std::optional<std::string> series;
  std::optional<std::string> x;
  sim::TimeWindow window;
  bool png = false;
};

/// A picture, and the messages about it.
struct Drawing {
  std::string svg;
  std::string remark;
};

void require_finite(const char* option, const std::optional<double>& seconds) {
  if (seconds && !std::isfinite(*seconds)) {
    throw InputError(option, 0, "a number that is not finite", "seconds from the start of the run");
  }
}

bool is_svg(const std::filesystem::path& path) {
  constexpr std::size_t max_head = 1000;  // enough for a declaration and comments of another program
  const std::string head = first_bytes(path, max_head);
  return head.starts_with('<') && head.find("<svg") != std::string::npos;
}

/// Throws InputError if the name's extension belongs to another format.
void require_format(const std::filesystem::path& picture, bool png) {
  constexpr std::array<std::string_view, 13> known{".svg", ".png",  ".jpg", ".jpeg", ".gif", ".webp", ".bmp",
                                                   ".tif", ".tiff", ".pdf", ".ps",   ".eps", ".html"};
  const std::string extension = lower_case(picture.extension().string());
  if (std::ranges::find(known, extension) != known.end() && extension != (png ? ".png" : ".svg")) {
    throw InputError("--out", 0, in_quotes(picture.string()),
                     png ? "a name that ends with .png, because of --png"
                         : "a name that ends with .svg: the picture is SVG; --png makes a PNG");
  }
}

std::filesystem::path picture_of(const Options& options, bool is_data_file) {
  const char* extension = options.png ? ".png" : ".svg";
  if (!options.out.empty()) {
    return options.out;
  }
  // So that a picture of columns does not replace that of the whole run.
  const std::string ending = (options.series ? ".series" : "") + std::string(extension);
  return is_data_file ? std::filesystem::path(options.recording).replace_extension(ending)
                      : beside_recording(options.recording, ending);
}

/// The series of a data file that are drawn without --series: the commands of its modules; else the motion of the
/// joints; else the first type.
std::vector<std::string> usual_series(const sim::DataFile& data) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& type) {
    for (const std::string& column : data.columns()) {
      if (column.starts_with(type + ".") && names.size() < sim::max_series) {
        names.push_back(column);
      }
    }
  };
  add("Angle");
  add("desired_angle");
  if (names.empty()) {
    add("real_joint_positions");
  }
  if (names.empty()) {
    constexpr std::size_t first_of_modules = 3;
    const std::string& column = data.columns()[first_of_modules];
    add(column.substr(0, column.find('.')));
  }
  return names;
}

std::string draw_table(const Options& options, std::vector<std::string> names, const sim::WriteTable& table) {
  const sim::SeriesSet set =
      sim::collect_series(table, {std::move(names), options.x.value_or("time_s"), options.window, options.recording});
  const std::string about = number_text(set.from_s) + " to " + number_text(set.to_s) + " s" +
                            (options.x && *options.x != "time_s" ? "; a dot marks the first value" : "");
  return sim::draw_series(set, shortened(std::filesystem::path(options.recording).filename().string(), 55), about);
}

Drawing draw_data_file(const Options& options) {
  sim::DataFile data(options.recording);
  std::vector<std::string> names = options.series ? std::vector{*options.series} : usual_series(data);
  std::string svg = draw_table(options, std::move(names), [&](const auto& write) { data.write_table(write); });
  return {std::move(svg), data.remark_on_cut()};
}

Drawing draw_recording(const Options& options) {
  const sim::Recording recording(options.recording);
  std::string svg = options.series ? draw_table(options, {*options.series},
                                                [&](const auto& write) { sim::write_tsv(recording, write); })
                                   : sim::draw_figure(recording, options.window);
  return {std::move(svg), sim::remark_on_unfinished_run(recording)};
}

int plot(const CommandLine& command_line, const Options& options) {
  require_finite("--from", options.window.from_s);
  require_finite("--to", options.window.to_s);
  const bool is_data_file = sim::is_xml_file(options.recording);
  if (options.x && !options.series && !is_data_file) {
    throw InputError("--x", 0, "no --series", "--series with the columns that are drawn over this one");
  }
  const std::filesystem::path picture = picture_of(options, is_data_file);
  require_format(picture, options.png);
  const Drawing drawing = is_data_file ? draw_data_file(options) : draw_recording(options);
  const std::array outputs{options.png ? PlannedOutput{"--out", picture, "PNG picture", starts_with("\x89PNG")}
                                       : PlannedOutput{"--out", picture, "SVG picture", is_svg}};
  const bool to_standard_output = options.out == "-";
  if (!to_standard_output) {
    check_outputs(outputs);
  }
  const std::string bytes = options.png ? png_of(drawing.svg) : drawing.svg;
  if (!drawing.remark.empty()) {
    print_warning(command_line.name(), drawing.remark);
  }
  if (!to_standard_output) {
    write_file(picture, bytes);
  }
  try {
    Output standard_output;
    standard_output.write(to_standard_output ? bytes : picture.string() + "\n");
    standard_output.finish();
  } catch (const ReaderGone&) {
    // The program at the other end of the pipe needed no more of the picture or its name.
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg plot",
      "Draws a recording of 'proleg simulate --record' as an SVG picture: the robot in a stride, the joint angles and\n"
      "the contacts over time, and the path of the robot over the whole run, from above. With --series it draws "
      "columns\n"
      "of the table of 'proleg export', of a recording or of a data file of the thesis. Prints the name of the "
      "picture.");
  Options options;
  command_line.add_option("RUN", options.recording, "the recording, or a data file (XML), of which it draws the angles")
      .required()
      .value_name("");
  command_line
      .add_option(
          "--series", options.series,
          "columns, with commas between them: angle_deg.J1,setpoint_deg.J1; angle_deg means that of every joint")
      .value_name("NAMES");
  command_line.add_option("--x", options.x, "the column over which they are drawn; by default time_s")
      .value_name("NAME");
  command_line.add_flag("--png", options.png, "write a PNG, with the program rsvg-convert (Debian: librsvg2-bin)");
  command_line
      .add_option(
          "--out", options.out,
          "the picture, - for standard output; by default run.svg (run.png) for run.proleg, run.1.svg for run.1; with\n"
          "--series run.series.svg")
      .value_name("FILE");
  command_line
      .add_option(
          "--from", options.window.from_s,
          "start of the time axis in s; by default three strides before its end, with --series the start of the\n"
          "run")
      .value_name("SECONDS");
  command_line.add_option("--to", options.window.to_s, "end of the time axis in s; by default the end of the run")
      .value_name("SECONDS");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return plot(command_line, options); });
}
