// proleg export: a recording as a table for other programs.

#include <array>
#include <filesystem>
#include <iostream>
#include <optional>

#include "shared/computer/output/output.hpp"
#include "shared/computer/output/output_check.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"
#include "tools/proleg/beside_recording.hpp"
#include "tools/proleg/command_line.hpp"

using namespace proleg;

int main(int argc, char** argv) {
  tools::CommandLine command_line(
      "proleg export",
      "Writes a recording of 'proleg simulate --record' as a table: a header line, then a line for each tick. Prints\n"
      "the name of the table.\n"
      "Columns: tick; time_s; for each joint setpoint_deg, servo_us, angle_deg, torque_Nm and current_mA (means over "
      "the\n"
      "tick) and its internal values; for each link x_m, y_m, z_m, its orientation qw, qx, qy, qz, contact_rear,\n"
      "contact_front, contact_N. Joint and link names follow the dot (setpoint_deg.J1).");
  std::string recording_path;
  std::string out;
  bool tsv = true;  // the only format
  command_line.add_option("RUN", recording_path, "the recording").required().value_name("");
  command_line.add_flag("--tsv", tsv, "write tab-separated values, as without this option");
  command_line
      .add_option("--out", out,
                  "the table; by default run.tsv for run.proleg, run.1.tsv for run.1; - for standard output")
      .value_name("FILE");

  return command_line.run(argc, argv, [&] {
    const sim::Recording recording(recording_path);
    const std::filesystem::path table =
        out.empty() ? tools::beside_recording(recording_path, ".tsv") : std::filesystem::path(out);
    const bool to_standard_output = out == "-";
    if (!to_standard_output) {
      const std::array outputs{PlannedOutput{"--out", table, "table", starts_with("tick\t")}};
      check_outputs(outputs);
    }
    if (const std::string remark = sim::remark_on_unfinished_run(recording); !remark.empty()) {
      tools::print_warning(command_line.name(), remark);
    }
    try {
      std::optional<Output> output;
      if (to_standard_output) {
        output.emplace();
      } else {
        output.emplace(table);
      }
      sim::write_tsv(recording, [&](std::string_view text) { output->write(text); });
      output->finish();
      if (!to_standard_output) {
        Output name;
        name.write(table.string() + "\n");
        name.finish();
      }
    } catch (const ReaderGone&) {
      return tools::exit_failed;  // `head` does this; no message
    }
    return tools::exit_success;
  });
}
