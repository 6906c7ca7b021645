// proleg plot: a recording as a picture.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/output/output_check.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/record/figure.hpp"
#include "sim/record/recording.hpp"
#include "tools/proleg/beside_recording.hpp"
#include "tools/proleg/command_line.hpp"

using namespace proleg;

namespace {

void require_finite(const char* option, const std::optional<double>& seconds) {
  if (seconds && !std::isfinite(*seconds)) {
    throw InputError(option, 0, "a number that is not finite", "seconds from the start of the run");
  }
}

bool is_picture(const std::filesystem::path& path) {
  constexpr std::size_t max_head = 1000;  // with a declaration and comments of another program
  const std::string head = first_bytes(path, max_head);
  return head.starts_with('<') && head.find("<svg") != std::string::npos;
}

/// Throws InputError for a name that promises a picture of another format.
void require_svg(const std::filesystem::path& picture) {
  constexpr std::array<std::string_view, 12> others{".png", ".jpg",  ".jpeg", ".gif", ".webp", ".bmp",
                                                    ".tif", ".tiff", ".pdf",  ".ps",  ".eps",  ".html"};
  const std::string extension = picture.extension().string();
  if (std::ranges::find(others, lower_case(extension)) != others.end()) {
    throw InputError("--out", 0, in_quotes(picture.string()),
                     "a name that ends with .svg: the picture is SVG, and other programs convert it");
  }
}

}  // namespace

int main(int argc, char** argv) {
  tools::CommandLine command_line(
      "proleg plot",
      "Draws a recording of 'proleg simulate --record' as an SVG picture: the robot in a stride, the joint angles and\n"
      "the contacts over time, and the path of the robot over the whole run, from above. Prints the name of the "
      "picture.");
  std::string recording_path;
  std::string out;
  sim::TimeWindow window;
  command_line.add_option("RUN", recording_path, "the recording").required().value_name("");
  command_line
      .add_option("--out", out, "the picture, an SVG file; by default run.svg for run.proleg, run.1.svg for run.1")
      .value_name("FILE");
  command_line
      .add_option("--from", window.from_s, "start of the time axis in s; by default three strides before its end")
      .value_name("SECONDS");
  command_line.add_option("--to", window.to_s, "end of the time axis in s; by default the end of the run")
      .value_name("SECONDS");

  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] {
    require_finite("--from", window.from_s);
    require_finite("--to", window.to_s);
    const sim::Recording recording(recording_path);
    const std::filesystem::path picture =
        out.empty() ? tools::beside_recording(recording_path, ".svg") : std::filesystem::path(out);
    require_svg(picture);
    const std::array outputs{PlannedOutput{"--out", picture, "SVG picture", is_picture}};
    check_outputs(outputs);
    if (const std::string remark = sim::remark_on_unfinished_run(recording); !remark.empty()) {
      tools::print_warning(command_line.name(), remark);
    }
    write_file(picture, sim::draw_figure(recording, window));
    try {
      Output standard_output;
      standard_output.write(picture.string() + "\n");
      standard_output.finish();
    } catch (const ReaderGone&) {
      // The picture is complete; only its name could not be printed.
    }
    return tools::exit_success;
  });
}
