#include "tools/proleg/hil/hil_options.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/fault/fault.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/common/run_measures.hpp"

namespace proleg::tools {
namespace {

/// The joint with a node id or a name.
unsigned parse_node_or_joint(const std::string& argument, const sim::Scenario& scenario) {
  if (const auto node = parse_whole<std::uint32_t>(argument)) {
    return joint_of_node(scenario, node, "--reset", argument);
  }
  const int joint = sim::find_joint(scenario.robot, argument);
  if (joint < 0) {
    throw InputError("--reset", 0, "unknown joint " + in_quotes(argument),
                     "a node id, or one of " + listed(sim::joint_names(scenario.robot)));
  }
  return static_cast<unsigned>(joint);
}

/// Parses JOINT@TICK or NODE@TICK.
sim::Restart parse_reset(const std::string& argument, const ScenarioRun& run) {
  const std::size_t at = argument.rfind('@');
  const auto tick =
      at == std::string::npos ? std::nullopt : parse_whole<std::uint32_t>(std::string_view(argument).substr(at + 1));
  if (!tick || at == 0) {
    throw InputError("--reset", 0, in_quotes(argument), "JOINT@TICK or NODE@TICK");
  }
  if (*tick == 0 || *tick >= run.ticks) {
    throw InputError("--reset", 0, "tick " + std::to_string(*tick),
                     "a tick of the run, 1 to " + std::to_string(run.ticks - 1));
  }
  const unsigned joint = parse_node_or_joint(argument.substr(0, at), run.scenario);
  if (joint == sim::HardwareLoop::sync_producer) {
    throw InputError("--reset", 0,
                     "node " + std::to_string(run.scenario.modules[joint].node) + " (" +
                         run.scenario.robot.joints[joint].name + "), which produces the SYNC",
                     "another node: without SYNC the robot stops");
  }
  return {*tick, joint};
}

std::vector<sim::Restart> parse_resets(const HilOptions& options, const ScenarioRun& run) {
  std::vector<sim::Restart> restarts;
  for (const std::string& argument : options.resets) {
    restarts.push_back(parse_reset(argument, run));
  }
  std::ranges::stable_sort(restarts, {}, &sim::Restart::tick);
  return restarts;
}

/// Parses ID#DATA@TICK, where ID#DATA is a frame in the form of cansend of can-utils.
sim::InjectedFrame parse_injected(const std::string& argument, const ScenarioRun& run) {
  const auto refuse = [&argument] {
    throw InputError(
        "--send", 0, in_quotes(argument),
        "ID#DATA@TICK: three hexadecimal digits up to 7FF, up to 8 bytes in hexadecimal, a tick; for example "
        "603#4018100100000000@100");
  };
  const std::size_t at = argument.find('@');
  if (at == std::string::npos) {
    refuse();
  }
  const auto tick = parse_whole<std::uint32_t>(std::string_view(argument).substr(at + 1));
  const auto frame = sim::parse_frame(std::string_view(argument).substr(0, at));
  if (!tick || !frame) {
    refuse();
  }
  const sim::InjectedFrame injected{*tick, *frame};
  if (*tick >= run.ticks) {
    throw InputError("--send", 0, "tick " + std::to_string(*tick),
                     "a tick of the run, 0 to " + std::to_string(run.ticks - 1));
  }
  return injected;
}

std::vector<sim::InjectedFrame> parse_frames(const HilOptions& options, const ScenarioRun& run) {
  std::vector<sim::InjectedFrame> frames;
  for (const std::string& argument : options.frames) {
    frames.push_back(parse_injected(argument, run));
  }
  std::ranges::stable_sort(frames, {}, &sim::InjectedFrame::tick);
  return frames;
}

/// Parses SEED:RATE.
sim::HardwareOptions::BitErrors parse_bit_errors(const std::string& argument) {
  const std::size_t colon = argument.find(':');
  const auto seed = parse_whole<std::uint64_t>(std::string_view(argument).substr(0, colon));
  const auto rate =
      colon == std::string::npos ? std::nullopt : parse_rate(std::string_view(argument).substr(colon + 1));
  if (!seed || !rate) {
    throw InputError("--bit-errors", 0, in_quotes(argument), "SEED:RATE, for example 7:1%");
  }
  return {*seed, *rate};
}

}  // namespace

void add_hil_options(CommandLine& command_line, HilOptions& options) {
  add_scenario_options(command_line, options);
  add_measures_option(command_line, options.all_measures);
  add_module_options(command_line, options);
  command_line.add_option(
      "--reset", options.resets,
      "JOINT@TICK or NODE@TICK: restart a module while the robot moves; it joins again. J3@1000 is the module of joint "
      "J3; a number is a node id (3@1000: node 3). Nodes count from the head, from 1, unless the robot's file numbers "
      "them. May be repeated.");
  command_line.add_option(
      "--send", options.frames,
      "ID#DATA@TICK: send this frame on the bus right after the SYNC of that tick; hexadecimal, as for "
      "cansend. --can-log shows the answer. May be repeated.");
  command_line.add_option("--bit-errors", options.bit_errors,
                          "SEED:RATE: destroy frames on the bus with this probability (7:1%). Their senders send them "
                          "again: nothing is lost, so nothing may differ.");
  command_line.add_option(
      "--faults", options.faults,
      "FILE, SEED or SEED:COUNT: let things fail as the schedule in the file says ('proleg faults' lists what can "
      "fail), or at random. With COUNT: run that many random schedules and report what they have in common. Status 1 "
      "if motion is not bounded as docs/safety.md says.");
  command_line.add_option("--can-log", options.can_log,
                          "write all frames of the bus into this file, in candump's log format");
}

sim::HardwareOptions hardware_options(const HilOptions& options, const ScenarioRun& run) {
  sim::HardwareOptions hardware;
  hardware.losses = &run.losses;
  hardware.restarts = parse_resets(options, run);
  hardware.injected = parse_frames(options, run);
  if (options.bit_errors) {
    hardware.bit_errors = parse_bit_errors(*options.bit_errors);
  }
  return hardware;
}

}  // namespace proleg::tools
