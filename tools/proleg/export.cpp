// proleg export: a recording as a table for other programs.

#include <array>
#include <iostream>
#include <optional>

#include "shared/computer/output/output.hpp"
#include "shared/computer/output/output_check.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"
#include "tools/proleg/command_line.hpp"

using namespace proleg;

int main(int argc, char** argv) {
  tools::CommandLine command_line(
      "proleg export",
      "Writes a recording of 'proleg simulate --record' as a table: a header line, then a line for each tick.\n"
      "Columns: tick; time_s; for each joint setpoint_deg, servo_us, angle_deg and its internal values; for each link\n"
      "x_m, y_m, z_m, contact_rear, contact_front. Joint and link names follow the dot (setpoint_deg.J1).");
  std::string recording_path;
  std::string out;
  bool tsv = true;  // the only format
  command_line.add_option("RUN", recording_path, "the recording").required().value_name("");
  command_line.add_flag("--tsv", tsv, "write tab-separated values, as without this option");
  command_line.add_option("--out", out, "write to this file instead of standard output").value_name("FILE");

  return command_line.run(argc, argv, [&] {
    const sim::Recording recording(recording_path);
    if (!out.empty()) {
      const std::array outputs{PlannedOutput{"--out", out, "table", starts_with("tick\t")}};
      check_outputs(outputs);
    }
    if (const std::string remark = sim::remark_on_unfinished_run(recording); !remark.empty()) {
      std::cerr << command_line.name() << ": " << remark << '\n';
    }
    try {
      std::optional<Output> output;
      if (out.empty()) {
        output.emplace();
      } else {
        output.emplace(out);
      }
      sim::write_tsv(recording, [&](std::string_view text) { output->write(text); });
      output->finish();
    } catch (const ReaderGone&) {
      return tools::exit_failed;  // `head` does this; no message
    }
    return tools::exit_success;
  });
}
