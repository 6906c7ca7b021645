#pragma once

// What all subcommands have in common that run a scenario: their options, interruption, and what they print.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/record/recorder.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/command_line.hpp"

namespace proleg::tools {

struct ScenarioOptions {
  std::string file;
  std::optional<std::string> seconds;
  std::optional<std::string> record;
  std::optional<std::string> losses;
  std::vector<std::string> settings;
  bool verbose = false;
  bool json = false;
};

void add_scenario_options(CommandLine& command_line, ScenarioOptions& options);

/// A scenario as the options want it.
struct ScenarioRun {
  sim::Scenario scenario;
  sim::Losses losses;
  std::uint32_t ticks;  ///< to be run
};

/// Throws InputError.
[[nodiscard]] ScenarioRun prepare_run(const ScenarioOptions& options);

/// The joint whose module has this node id. Throws InputError if there is none; option, found: what the user gave.
[[nodiscard]] unsigned joint_of_node(const sim::Scenario& scenario, std::optional<std::uint32_t> node,
                                     const std::string& option, const std::string& found);

/// Every parameter of every joint, as the run starts with it, and the remarks on the files; on standard error.
void print_setup(const sim::Scenario& scenario);

/// The recorder that --record asks for, if it does. program: what computes the gait. Throws InputError: nothing has run
/// yet, so it is the name that was wrong.
[[nodiscard]] std::unique_ptr<sim::Recorder> open_recorder(const ScenarioOptions& options,
                                                           const sim::Scenario& scenario, const std::string& program);

/// From now on SIGINT, SIGTERM and SIGHUP only make `interrupted` true, unless they are ignored (nohup).
void catch_interrupts();
[[nodiscard]] bool interrupted();

/// For messages about a run that ended early: where what was done is kept; empty without a recording.
[[nodiscard]] std::string kept_in_recording(const ScenarioOptions& options);

}  // namespace proleg::tools
