#pragma once

// Common parts of all subcommands that run a scenario: options, interruption, output.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/output/output.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

struct ScenarioOptions {
  std::string file;
  std::optional<std::string> seconds;
  std::optional<std::string> record;
  std::optional<std::string> losses;
  sim::OverrideWords overrides;
  std::vector<std::string> settings;
  std::vector<std::string> moves;
  bool all_measures = false;
  bool verbose = false;
  bool json = false;
};

/// Adds the options that replace values of the scenario at the start of a run.
void add_override_options(CommandLine& command_line, ScenarioOptions& options);
/// Throws InputError for an option of simulated worlds: an override, or one of the others that are given.
void refuse_world_options(const ScenarioOptions& options,
                          std::initializer_list<std::pair<const char*, bool>> others = {});
/// Adds --move, for programs that simulate the gait in memory.
void add_move_option(CommandLine& command_line, ScenarioOptions& options);
/// Adds the scenario's file, the length of the run, and the override options.
void add_start_options(CommandLine& command_line, ScenarioOptions& options);
/// Adds all options.
void add_scenario_options(CommandLine& command_line, ScenarioOptions& options);

/// A scenario with the options applied.
struct ScenarioRun {
  sim::Scenario scenario;
  sim::Losses losses;
  std::uint32_t ticks;  ///< length of the run
};

/// Throws InputError if the path is a folder; the message names the files in it with this end of their names, e.g.
/// ".simulation.xml".
void refuse_folder(const std::filesystem::path& path, const std::string& suffix);

/// Gives the scenario another length, a number of seconds from 0.01 to 86400. option: for the message. Throws
/// InputError.
void set_duration(sim::Scenario& scenario, const std::string& option, const std::string& seconds);

/// The length of a run in ticks. Throws InputError if a change or a move takes effect after it.
[[nodiscard]] std::uint32_t run_ticks(const sim::Scenario& scenario);

/// Reads the scenario and applies the options. Throws InputError.
[[nodiscard]] ScenarioRun prepare_run(const ScenarioOptions& options);
/// Reads the scenario from files that need not be on disk, and applies the options. Throws InputError.
[[nodiscard]] ScenarioRun prepare_run(const ScenarioOptions& options, sim::FileSource& files);

/// The joint whose module has a node id. Throws InputError if no module has it. option, found: the user's arguments,
/// for the message.
[[nodiscard]] unsigned joint_of_node(const sim::Scenario& scenario, std::optional<std::uint32_t> node,
                                     const std::string& option, const std::string& found);

/// Prints the warnings on the files on standard error: the first ones, and the number of the others.
void print_warnings(const std::string& program, const sim::Scenario& scenario);

/// Prints a warning if the limits of a joint cut its set-points in more than one tick of a hundred; it names the joint
/// that is cut most. clipped_ticks: number of ticks for each joint. ticks: length of the run.
void print_warning_on_clipping(const std::string& program, const sim::Scenario& scenario,
                               std::span<const std::uint32_t> clipped_ticks, std::uint32_t ticks);

/// Prints the remarks on the files and the start value of every parameter of every joint on standard error.
void print_setup(const sim::Scenario& scenario);

/// The overrides for --json; null for a value of the files.
[[nodiscard]] Json overrides_object(const sim::Overrides& overrides);

/// The file of --record, for check_outputs(); empty without that option.
[[nodiscard]] std::vector<PlannedOutput> planned_recording(const ScenarioOptions& options);

/// The recorder for --record; null without that option. program: the program that computes the gait. Throws BadInput if
/// the file cannot be created.
[[nodiscard]] std::unique_ptr<sim::Recorder> open_recorder(const ScenarioOptions& options,
                                                           const sim::Scenario& scenario, const std::string& program);

/// Text on the effect of --losses: "2969 of 59900 (5.0 %); a frame counts once for each joint that is to receive it".
[[nodiscard]] std::string losses_text(std::uint64_t lost, std::uint64_t receptions);

/// Text "; the run until then is in FILE", for messages about a run that ended early; empty without a recording.
[[nodiscard]] std::string kept_in_recording(const ScenarioOptions& options);

}  // namespace proleg::tools
