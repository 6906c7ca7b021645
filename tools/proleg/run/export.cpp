// proleg export: writes a recording as a table for other programs, as a data file of the thesis, or as a page that
// plays it; writes a data file as a table.

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/deflate/deflate.hpp"
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
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/document/telemetry_row.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using nlohmann::json;

using Write = std::function<void(std::string_view)>;

/// Some ticks of a recording in the form of the player (docs/page-interface.md, The file of a recording): columns of
/// differences, which compress well.
class ColumnBlock {
 public:
  static constexpr std::size_t max_rows = 4096;

  explicit ColumnBlock(std::size_t columns) : columns_(columns) {}

  /// Adds a row; the block must not be full.
  void add(std::span<const std::int32_t> row);
  [[nodiscard]] bool is_empty() const { return rows_ == 0; }
  [[nodiscard]] bool is_full() const { return rows_ == max_rows; }
  /// Takes the rows as text, in base64, and empties the block.
  [[nodiscard]] std::string take();

 private:
  std::size_t columns_;
  std::size_t rows_ = 0;
  std::vector<std::int32_t> values_;  ///< values row by row
};

void ColumnBlock::add(std::span<const std::int32_t> row) {
  values_.insert(values_.end(), row.begin(), row.end());
  ++rows_;
}

std::string ColumnBlock::take() {
  std::string bytes;
  bytes.reserve(values_.size() * sizeof(std::int32_t));
  for (std::size_t column = 0; column < columns_; ++column) {
    std::uint32_t before = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      const auto value = static_cast<std::uint32_t>(values_[row * columns_ + column]);
      const std::uint32_t difference = value - before;
      before = value;
      for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes += static_cast<char>(difference >> shift & 0xFFU);
      }
    }
  }
  rows_ = 0;
  values_.clear();
  return base64(deflate(bytes));
}

constexpr std::string_view place_mark = "<!-- the recording -->";

/// JSON as the text of an HTML element. Names come from files of other people: a text without "<" cannot end the
/// element.
std::string element_text(const json& document) {
  std::string text;
  for (const char character : document.dump(-1, ' ', true, json::error_handler_t::replace)) {
    if (character == '<') {
      text += "\\u003c";
    } else {
      text += character;
    }
  }
  return text;
}

json documents_of(const sim::Recording& recording, const sim::Scenario& scenario, const host::SignalLayout& layout) {
  return {{"block_rows", ColumnBlock::max_rows},
          {"robot", robot_document(scenario, "recording")},
          {"parameters", recorded_parameters_document(recording, scenario)},
          {"telemetry", layout.document(recording.tick_period_us())},
          {"recording", recording_document(recording)}};
}

/// The page that tools/page builds for recordings (host/page/source/player). It shows nothing without a recording.
class PlayerPage {
 public:
  /// The text at the begin of all files that write_html() writes.
  static constexpr std::string_view first_text = "<!doctype html>\n<!-- A recording of Proleg";

  /// Reads the file. Throws BadInput if it is missing, or is no player.
  explicit PlayerPage(const std::filesystem::path& file);

  [[nodiscard]] std::string_view before_recording() const { return std::string_view(text_).substr(0, place_); }
  [[nodiscard]] std::string_view after_recording() const;

 private:
  std::string text_;
  std::size_t place_ = 0;  ///< position of the recording in the text
};

PlayerPage::PlayerPage(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  text_ = text.str();
  place_ = text_.find(place_mark);
  if (!stream || !text_.starts_with(first_text) || place_ == std::string::npos) {
    throw BadInput("found no player in " + file.string() + ", expected one that tools/page has built");
  }
}

std::string_view PlayerPage::after_recording() const {
  return std::string_view(text_).substr(place_ + place_mark.size());
}

/// Writes the page with the recording in it (docs/page-interface.md, The file of a recording). scenario: scenario_of()
/// the recording. after_tick: called after each tick. It needs memory for some thousand ticks, independently of the
/// recording's length.
void write_html(const sim::Recording& recording, const sim::Scenario& scenario, const PlayerPage& player,
                const std::function<void(std::string_view)>& write,
                const std::function<void(std::uint32_t tick)>& after_tick) {
  const host::SignalLayout layout(signals_of(scenario));
  write(player.before_recording());
  write("<script type=\"application/json\" id=\"documents\">");
  write(element_text(documents_of(recording, scenario, layout)));
  write("</script>\n");
  ColumnBlock block(layout.row_size());
  const auto write_block = [&] {
    write("<script type=\"text/plain\" class=\"ticks\">");
    write(block.take());
    write("</script>\n");
  };
  std::vector<std::int32_t> row;
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const sim::RecordedTick& tick) {
    fill_row(tick, scenario, row);
    block.add(row);
    if (block.is_full()) {
      write_block();
    }
    after_tick(tick.tick);
  });
  if (!block.is_empty()) {
    write_block();
  }
  write(player.after_recording());
}

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
      "Columns: tick; time_s; for each joint setpoint_deg, servo_us, angle_deg, torque_Nm and current_mA (means over "
      "the\n"
      "tick) and its internal values; for each link x_m, y_m, z_m, its orientation qw, qx, qy, qz, contact_rear,\n"
      "contact_front, contact_N. Joint and link names follow the dot (setpoint_deg.J1).");
  Options options;
  command_line.add_option("RUN", options.recording, "the recording, or a data file").required().value_name("");
  command_line.add_flag("--tsv", options.tsv, "write tab-separated values, as without this option");
  command_line
      .add_flag("--html", options.html, "write a page that plays the recording in 3D, one file; prints its size too")
      .excludes("--tsv");
  command_line.add_flag("--thesis", options.thesis, "write a data file of the thesis (listing B.8; docs/recordings.md)")
      .excludes("--tsv")
      .excludes("--html");
  command_line
      .add_option(
          "--out", options.out,
          "the file; by default run.tsv, run.data.xml or run.html for run.proleg, run.1.tsv for run.1; - for standard\n"
          "output")
      .value_name("FILE");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return export_recording(command_line, options); });
}
