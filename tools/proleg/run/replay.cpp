// proleg replay: recomputes the gait of a recording.

#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/loop/verification.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/record/recording.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct Options {
  std::string file;
  bool verify = true;  ///< the only task
  bool json = false;
};

/// A value of the recording's results; empty if the run was not finished.
std::string recorded(const sim::Recording& recording, const std::string& name) {
  for (const auto& [key, value] : recording.results()) {
    if (key == name) {
      return value;
    }
  }
  return {};
}

std::string fingerprint_text() { return hexadecimal(core_fingerprint, 8); }

sim::Verification recompute(const sim::Recording& recording) {
  RunProgress progress("recomputing", recording.time_s(recording.last_tick()));
  return sim::verify(recording, [&](std::uint32_t tick) { progress.show(recording.time_s(tick)); });
}

int replay(const Options& options) {
  const sim::Recording recording(options.file);
  if (const std::string remark = remark_on_unfinished_run(recording); !remark.empty()) {
    print_warning("proleg replay", remark);
  }
  const sim::Verification verification = recompute(recording);
  const std::string first =
      verification.first ? describe(*verification.first, recording.joints()[verification.first->joint].name) : "";
  // The tables must have the hashes that the run printed.
  const std::string setpoint_hash = recorded(recording, "setpoint_hash");
  const std::string servo_hash = recorded(recording, "servo_hash");
  const bool same_hashes = !recording.finished() || verification.first_fault_tick ||
                           (setpoint_hash == verification.setpoint_hash && servo_hash == verification.servo_hash);
  const bool holds = verification.differences == 0 && same_hashes;
  const std::string core = recording.run_value("core_fingerprint");
  const std::string user_algorithms = recording.run_value("user_algorithms");
  if (options.json) {
    const Json object{{"recording", options.file},
                      {"ticks", verification.ticks},
                      {"setpoints", verification.setpoints},
                      {"servo_commands", verification.servo_commands},
                      {"internal_values", verification.internal_values},
                      {"first_fault_tick", verification.first_fault_tick},
                      {"differences", verification.differences},
                      {"first_difference", first},
                      {"setpoint_hash", verification.setpoint_hash},
                      {"servo_hash", verification.servo_hash},
                      {"recorded_setpoint_hash", setpoint_hash},
                      {"recorded_servo_hash", servo_hash},
                      {"same_hashes", same_hashes},
                      {"verified", holds},
                      {"recorded_by", recording.run_value("program")},
                      {"recorded_build_id", recording.run_value("build_id")},
                      {"recorded_core_fingerprint", core},
                      {"core_fingerprint", fingerprint_text()},
                      {"recorded_user_algorithms", user_algorithms},
                      {"build_id", build_id}};
    std::cout << object.text() << '\n';
  } else {
    std::printf("recorded by       %s, %s, core %s%s\n", recording.run_value("program").c_str(),
                recording.run_value("build_id").c_str(), core.c_str(),
                user_algorithms.empty() ? "" : (", " + one_line(user_algorithms)).c_str());
    std::printf("recomputed        %u ticks: %llu set-points, %llu servo commands, %llu internal values\n",
                verification.ticks, static_cast<unsigned long long>(verification.setpoints),
                static_cast<unsigned long long>(verification.servo_commands),
                static_cast<unsigned long long>(verification.internal_values));
    if (verification.first_fault_tick) {
      std::printf("until             tick %u, in which the first fault begins\n", *verification.first_fault_tick);
    }
    std::printf("differences       %llu\n", static_cast<unsigned long long>(verification.differences));
    std::printf("set-point hash    %s\n", verification.setpoint_hash.c_str());
    std::printf("servo hash        %s\n", verification.servo_hash.c_str());
  }
  const std::vector<std::string> others = sim::other_algorithms(recording);
  if (!holds) {
    std::cerr << "proleg replay: " << options.file << ": "
              << (first.empty() ? "the tables do not have the hashes of the results" : first) << '\n';
    for (const std::string& sentence : others) {
      std::cerr << "proleg replay: " << one_line(sentence) << '\n';
    }
    return exit_failed;
  }
  for (const std::string& sentence : others) {
    print_warning("proleg replay", sentence + "; both compute the same");
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg replay",
      "Recomputes the gait of a recording from its start values, changes, contacts, losses and restarts, and compares "
      "it with the recording bit for bit.");
  Options options;
  command_line.add_option("FILE", options.file, "a recording").required();
  command_line.add_flag(
      "--verify", options.verify,
      "compare every set-point, internal value and servo command, as without this option; exit status 1 if "
      "one differs");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return replay(options); });
}
