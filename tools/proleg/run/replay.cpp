// proleg replay: recomputes the gait of a recording.

#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/loop/motion_check.hpp"
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
  bool verify = true;     ///< the only task
  bool commands = false;  ///< without the motion
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

sim::Verification recompute(const sim::Recording& recording, sim::MotionCheck* motion) {
  RunProgress progress("recomputing", recording.time_s(recording.last_tick()));
  return sim::verify(
      recording, [&](std::uint32_t tick) { progress.show(recording.time_s(tick)); }, motion);
}

/// The place at which the motion departs first; empty if it does not.
std::string first_of(const sim::MotionCheck& motion, const sim::Recording& recording) {
  if (const std::optional<sim::MotionDifference>& first = motion.first()) {
    return "at tick " + std::to_string(first->tick) + " (" + number_text(recording.time_s(first->tick)) + " s), " +
           name_of(*first, recording);
  }
  return motion.differences() > 0 ? motion.obstacle() : "";
}

/// What is wrong with the motion, in one line; empty if nothing is.
std::string complaint_on(const sim::MotionCheck& motion, const sim::Recording& recording) {
  if (const std::string first = first_of(motion, recording); !first.empty()) {
    return "the motion departs from that of this program: " + first;
  }
  if (const std::optional<std::uint32_t> damaged = motion.damaged_hash()) {
    return "found a hash of the motion until tick " + std::to_string(*damaged) +
           " that is not that of the recorded poses, expected an undamaged table 'motion_hash'";
  }
  return {};
}

std::string motion_text(const sim::MotionCheck& motion, const sim::Recording& recording) {
  if (motion.ticks() == 0 && motion.differences() == 0) {
    return "not compared: " + motion.obstacle();
  }
  if (const std::string first = first_of(motion, recording); !first.empty()) {
    return "departs " + first + "; " + std::to_string(motion.differences()) + " of " + std::to_string(motion.ticks()) +
           " ticks differ";
  }
  return "equal in " + std::to_string(motion.ticks()) + " ticks: all poses, bit for bit" +
         (motion.obstacle().empty() ? "" : "; not compared later: " + motion.obstacle());
}

std::string table_text(const sim::MotionCheck& motion) {
  if (motion.damaged_hash()) {
    return "not that of its poses";
  }
  return motion.table_hashes() == 0 ? "none" : std::to_string(motion.table_hashes()) + " recorded, those of its poses";
}

Json motion_object(const sim::MotionCheck& motion, const sim::Recording& recording) {
  const std::optional<sim::MotionDifference>& first = motion.first();
  return {{"compared_ticks", motion.ticks()},
          {"not_compared", motion.obstacle()},
          {"differences", motion.differences()},
          {"first_tick", first ? Json(first->tick) : Json()},
          {"first_time_s", first ? Json(recording.time_s(first->tick)) : Json()},
          {"first_part", first ? Json(name_of(*first, recording)) : Json()},
          {"hash", motion.hash()},
          {"recorded_hash", motion.recorded_hash()},
          {"table_hashes", motion.table_hashes()},
          {"first_damaged_hash_tick", motion.damaged_hash()}};
}

int replay(const Options& options) {
  const sim::Recording recording(options.file);
  if (const std::string remark = remark_on_unfinished_run(recording); !remark.empty()) {
    print_warning("proleg replay", remark);
  }
  std::optional<sim::MotionCheck> motion;
  if (!options.commands) {
    motion.emplace(recording);
  }
  const sim::Verification verification = recompute(recording, motion ? &*motion : nullptr);
  const std::string first =
      verification.first ? describe(*verification.first, recording.joints()[verification.first->joint].name) : "";
  // The tables must have the hashes that the run printed.
  const std::string setpoint_hash = recorded(recording, "setpoint_hash");
  const std::string servo_hash = recorded(recording, "servo_hash");
  const bool same_hashes = !recording.finished() || verification.first_fault_tick ||
                           (setpoint_hash == verification.setpoint_hash && servo_hash == verification.servo_hash);
  const bool same_commands = verification.differences == 0 && same_hashes;
  const std::string complaint = motion ? complaint_on(*motion, recording) : "";
  const bool holds = same_commands && complaint.empty();
  const std::uint64_t differences = verification.differences + (motion ? motion->differences() : 0);
  const std::string processor = recording.run_value("processor");
  const std::string core = recording.run_value("core_fingerprint");
  const std::string user_algorithms = recording.run_value("user_algorithms");
  if (options.json) {
    const Json object{{"recording", options.file},
                      {"ticks", verification.ticks},
                      {"setpoints", verification.setpoints},
                      {"servo_commands", verification.servo_commands},
                      {"internal_values", verification.internal_values},
                      {"first_fault_tick", verification.first_fault_tick},
                      {"differences", differences},
                      {"command_differences", verification.differences},
                      {"first_difference", first.empty() ? complaint : first},
                      {"motion", motion ? motion_object(*motion, recording) : Json()},
                      {"setpoint_hash", verification.setpoint_hash},
                      {"servo_hash", verification.servo_hash},
                      {"recorded_setpoint_hash", setpoint_hash},
                      {"recorded_servo_hash", servo_hash},
                      {"same_hashes", same_hashes},
                      {"verified", holds},
                      {"recorded_by", recording.run_value("program")},
                      {"recorded_build_id", recording.run_value("build_id")},
                      {"recorded_processor", processor},
                      {"processor", sim::processor_text()},
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
    std::printf("differences       %llu\n", static_cast<unsigned long long>(differences));
    std::printf("commands          %s\n", same_commands   ? "equal: set-points, servo commands and internal values"
                                          : first.empty() ? "their hashes are not those of the results"
                                                          : first.c_str());
    std::printf("motion            %s\n",
                motion ? motion_text(*motion, recording).c_str() : "not compared: --commands was given");
    std::printf("set-point hash    %s\n", verification.setpoint_hash.c_str());
    std::printf("servo hash        %s\n", verification.servo_hash.c_str());
    if (motion && motion->ticks() > 0) {
      std::printf("motion hash       %s\n", motion->hash().c_str());
    }
    if (motion) {
      std::printf("hashes of motion  %s\n", table_text(*motion).c_str());
    }
  }
  const std::vector<std::string> others = sim::other_algorithms(recording);
  if (!same_commands) {
    std::cerr << "proleg replay: " << options.file << ": "
              << (first.empty() ? "the tables do not have the hashes of the results" : first) << '\n';
    for (const std::string& sentence : others) {
      std::cerr << "proleg replay: " << one_line(sentence) << '\n';
    }
  }
  if (!complaint.empty()) {
    std::cerr << "proleg replay: " << options.file << ": " << complaint << '\n';
    for (const std::string& sentence : sim::other_program(recording, build_id)) {
      std::cerr << "proleg replay: " << one_line(sentence)
                << "; its motion is repeated only there, and --commands compares the rest\n";
    }
  }
  if (!holds) {
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
      "Recomputes the gait of a recording from its start values, changes, contacts, losses and restarts, simulates its "
      "world again, and compares both with the recording bit for bit.");
  Options options;
  command_line.add_option("FILE", options.file, "a recording").required();
  command_line.add_flag(
      "--verify", options.verify,
      "compare every set-point, internal value, servo command and pose, as without this option; exit status 1 if "
      "one differs");
  command_line.add_flag("--commands", options.commands,
                        "compare no poses: those of another program or processor may differ");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return replay(options); });
}
