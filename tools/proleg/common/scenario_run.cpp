#include "tools/proleg/common/scenario_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/record/recording_file.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"

namespace proleg::tools {
namespace {

static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void set_duration(sim::Scenario& scenario, const std::string& option, const std::string& seconds) {
  const std::optional<double> number = parse_number(seconds);
  if (!number || *number < 0.01 || *number > 86'400.0) {
    throw InputError(option, 0, in_quotes(seconds), "0.01 to 86400 seconds");
  }
  scenario.duration_s = *number;
}

std::uint32_t run_ticks(const sim::Scenario& scenario) {
  const std::uint32_t ticks = sim::tick_count(scenario);
  const auto require_before_end = [ticks](const char* option, std::uint32_t tick) {
    if (tick >= ticks) {
      throw InputError(option, 0, "tick " + std::to_string(tick),
                       "a tick before the end of the run, below " + std::to_string(ticks));
    }
  };
  if (!scenario.changes.empty()) {
    require_before_end("--set", scenario.changes.back().tick);
  }
  if (!scenario.moves.empty()) {
    require_before_end("--move", scenario.moves.back().tick);
  }
  return ticks;
}

void add_start_options(CommandLine& command_line, ScenarioOptions& options) {
  add_scenario(command_line, options.file, "scenario").required();
  command_line.add_option("--seconds", options.seconds, "simulated time; by default the duration in the scenario");
  add_override_options(command_line, options);
}

void add_override_options(CommandLine& command_line, ScenarioOptions& options) {
  command_line.add_option("--set", options.settings,
                          "NAME=VALUE[@TICK]: change a parameter at the start, at a tick, or at a time (@5s). NAME is "
                          "[MODULE.]PARAMETER[:JOINT], where "
                          "PARAMETER may also be an internal value. May be repeated.");
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    command_line.add_option("--" + std::string(declaration.name), options.overrides.*declaration.word,
                            std::string(declaration.help));
  }
}

void refuse_world_options(const ScenarioOptions& options, std::initializer_list<std::pair<const char*, bool>> others) {
  std::vector<std::pair<std::string, bool>> given(others.begin(), others.end());
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    given.emplace_back("--" + std::string(declaration.name),
                       declaration.of_simulated_world && (options.overrides.*declaration.word).has_value());
  }
  for (const auto& [option, is_given] : given) {
    if (is_given) {
      throw InputError(option, 0, "an option for simulated worlds", "none of them: the robot is where it is");
    }
  }
}

void add_move_option(CommandLine& command_line, ScenarioOptions& options) {
  command_line.add_option(
      "--move", options.moves,
      "X,Y,Z,DEGREES@TICK: put the robot elsewhere, as a hand does it: at a tick or a time (@5s) the "
      "head's frame comes to X,Y,Z (metres), the robot is turned about the vertical to the left, "
      "and rests. A robot inside the ground is lifted onto it. The measures leave the move out. "
      "May be repeated.");
}

void add_scenario_options(CommandLine& command_line, ScenarioOptions& options) {
  add_start_options(command_line, options);
  command_line.add_option(
      "--record", options.record,
      "write a recording (SQLite) into this file, which replaces an earlier recording and no other file");
  command_line.add_option(
      "--losses", options.losses,
      "state frames that joints do not receive: SEED:RATE or SEED:RATE@FIRST-LAST (RATE 0.05 or 5%), or a "
      "file with lines TICK SENDER RECEIVER [CHANNEL]");
  command_line.add_flag("--verbose", options.verbose,
                        "print the order of the joints, remarks on the files and all parameters");
  command_line.add_flag("--json", options.json, "print one JSON object");
}

void refuse_folder(const std::filesystem::path& path, const std::string& suffix) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    return;
  }
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().string().ends_with(suffix)) {
      names.push_back(entry->path().filename().string());
    }
  }
  std::ranges::sort(names);
  throw InputError(
      path.string(), 0, "a folder",
      "a *" + suffix + " file; " + (names.empty() ? "there is none in the folder" : "in the folder: " + listed(names)));
}

ScenarioRun prepare_run(const ScenarioOptions& options) {
  refuse_folder(options.file, ".simulation.xml");
  sim::DiskFiles files;
  return prepare_run(options, files);
}

ScenarioRun prepare_run(const ScenarioOptions& options, sim::FileSource& files) {
  ScenarioRun run{sim::read_scenario(options.file, files, sim::read_overrides(options.overrides)), {}, 0};
  for (const std::string& setting : options.settings) {
    sim::apply_setting(run.scenario, setting);
  }
  if (const auto contradiction = sim::find_contradiction(run.scenario)) {
    throw InputError("--set", 0, contradiction->found, contradiction->expected);
  }
  if (options.seconds) {
    set_duration(run.scenario, "--seconds", *options.seconds);
  }
  for (const std::string& move : options.moves) {
    sim::add_move(run.scenario, move);
  }
  run.ticks = run_ticks(run.scenario);
  if (options.losses) {
    run.losses = sim::read_losses(*options.losses, run.scenario.robot);
    run.losses.require_effect(run.ticks, run.scenario.kernel);
  }
  return run;
}

unsigned joint_of_node(const sim::Scenario& scenario, std::optional<std::uint32_t> node, const std::string& option,
                       const std::string& found) {
  std::string nodes;
  for (unsigned joint = 0; joint < scenario.modules.size(); ++joint) {
    if (node && scenario.modules[joint].node == *node) {
      return joint;
    }
    nodes += (nodes.empty() ? "" : ", ") + std::to_string(scenario.modules[joint].node);
  }
  throw InputError(option, 0, "node " + found, "one of " + nodes);
}

void print_warnings(const std::string& program, const sim::Scenario& scenario) {
  constexpr std::size_t max_lines = 10;
  const std::size_t count = scenario.warnings.size();
  const std::size_t shown = count > max_lines ? max_lines - 1 : count;
  for (std::size_t i = 0; i < shown; ++i) {
    print_warning(program, scenario.warnings[i]);
  }
  if (count > shown) {
    print_warning(program, std::to_string(count - shown) + " more of this kind");
  }
}

void print_warning_on_clipping(const std::string& program, const sim::Scenario& scenario,
                               std::span<const std::uint32_t> clipped_ticks, std::uint32_t ticks) {
  constexpr double noticeable = 0.01;
  const auto share = [&](std::uint32_t clipped) { return clipped / std::max(1.0, 1.0 * ticks); };
  const auto above = std::ranges::count_if(clipped_ticks, [&](auto clipped) { return share(clipped) > noticeable; });
  if (above == 0) {
    return;
  }
  const auto worst = static_cast<std::size_t>(std::ranges::max_element(clipped_ticks) - clipped_ticks.begin());
  const auto in_degrees = [](std::int32_t limit) { return number_text(limit * 45.0 / (1U << 29U)); };
  const AngleLimits& limits = scenario.joint_limits[worst];
  std::string text = "the limits of " + scenario.robot.joints[worst].name + ", " + in_degrees(limits.lower) + " to " +
                     in_degrees(limits.upper) + " degrees, clip its set-points in " +
                     std::to_string(std::lround(100.0 * share(clipped_ticks[worst]))) + " % of the ticks";
  if (above > 1) {
    text += " (" + std::to_string(above) + " joints are clipped)";
  }
  print_warning(program, text);
}

void print_setup(const sim::Scenario& scenario) {
  for (const std::string& remark : scenario.remarks) {
    std::cerr << remark << '\n';
  }
  for (unsigned s = 0; s < max_slots; ++s) {
    const Slot& slot = scenario.kernel.slots[s];
    if (slot.algorithm == nullptr) {
      continue;
    }
    const Declaration& declaration = slot.algorithm->declaration();
    std::cerr << declaration.name << '\n';
    for (unsigned p = 0; p < declaration.parameters.size(); ++p) {
      const Parameter& parameter = declaration.parameters[p];
      const std::string unit = sim::shown_unit(parameter.unit);
      std::cerr << "  " << parameter.name << (unit.empty() ? "" : " [" + unit + "]");
      for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
        if (slot.group.contains(joint)) {
          std::cerr << ' ' << scenario.robot.joints[joint].name << '='
                    << format_decimal(start_value(scenario, s, joint, p), parameter.unit).view();
        }
      }
      std::cerr << '\n';
    }
  }
}

std::vector<PlannedOutput> planned_recording(const ScenarioOptions& options) {
  if (!options.record) {
    return {};
  }
  return {{"--record", *options.record, "recording", sim::is_recording, true, sim::recording_companions()}};
}

Json overrides_object(const sim::Overrides& overrides) {
  const sim::OverrideWords words = sim::words_of(overrides);
  return {{"engine", words.engine},
          {"seed", overrides.seed},
          {"friction", overrides.friction},
          {"at", words.at},
          {"heading_deg", overrides.heading_deg}};
}

std::unique_ptr<sim::Recorder> open_recorder(const ScenarioOptions& options, const sim::Scenario& scenario,
                                             const std::string& program) {
  if (!options.record) {
    return nullptr;
  }
  std::error_code missing;
  const bool replaces = std::filesystem::file_size(*options.record, missing) > 0 && !missing;
  try {
    // The path follows a link, so that the recording replaces the file that the link names.
    auto recorder = std::make_unique<sim::Recorder>(follow_links(*options.record), scenario, program, build_id);
    if (replaces) {
      std::cerr << "proleg " << program.substr(0, program.find(' ')) << ": replaces " << one_line(*options.record)
                << '\n';
    }
    return recorder;
  } catch (const FileError& error) {
    throw BadInput(error.what());
  }
}

std::string losses_text(std::uint64_t lost, std::uint64_t receptions) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "%llu of %llu (%.1f %%); a frame counts once for each joint that is to receive it",
                static_cast<unsigned long long>(lost), static_cast<unsigned long long>(receptions),
                receptions > 0 ? 100.0 * static_cast<double>(lost) / static_cast<double>(receptions) : 0.0);
  return text.data();
}

std::string kept_in_recording(const ScenarioOptions& options) {
  return options.record ? "; the run until then is in " + *options.record : "";
}

}  // namespace proleg::tools
