// proleg faults: prints the faults of a run of proleg hil, for the user and as the table of docs/faults.md; and
// schedules of faults: the random one of a seed, or that of a recording.

#include <iostream>
#include <optional>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/fault/fault.hpp"
#include "sim/record/recording.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct FaultsOptions : ScenarioOptions {
  bool markdown = false;
  std::optional<std::string> schedule;
  bool chips = false;
  std::optional<std::string> recording;
};

void print_kinds(std::ostream& out) {
  for (const sim::FaultDeclaration& kind : sim::fault_declarations()) {
    out << form_of(kind) << "\n    " << kind.help << (kind.needs_chip ? " Only with --modules mcu." : "") << '\n';
  }
  out << "\nTIME is a number with s, ms or us, from SYNC 0 on; JOINT a joint's name, or * for all. docs/faults.md has\n"
         "examples.\n";
}

void print_markdown(std::ostream& out) {
  out << "| line | what happens | native modules |\n| --- | --- | --- |\n";
  for (const sim::FaultDeclaration& kind : sim::fault_declarations()) {
    std::string form = form_of(kind);
    for (std::size_t bar = form.find('|'); bar != std::string::npos; bar = form.find('|', bar + 2)) {
      form.insert(bar, "\\");
    }
    out << "| `" << form << "` | " << kind.help << " | " << (kind.needs_chip ? "no" : "yes") << " |\n";
  }
}

int faults(const FaultsOptions& options) {
  if (options.markdown) {
    print_markdown(std::cout);
  } else if (options.recording) {
    for (const sim::RecordedFault& fault : sim::Recording(*options.recording).faults()) {
      std::cout << fault.text << '\n';
    }
  } else if (options.schedule) {
    if (options.file.empty()) {
      throw InputError("--schedule", 0, "no scenario", "proleg faults FILE --schedule SEED");
    }
    const auto seed = parse_whole<std::uint64_t>(*options.schedule);
    if (!seed) {
      throw InputError("--schedule", 0, in_quotes(*options.schedule), "SEED, a whole number");
    }
    const ScenarioRun run = prepare_run(options);
    const std::uint64_t run_us = std::uint64_t{run.ticks} * run.scenario.kernel.tick_period_us;
    if (run_us < sim::min_random_run_us) {
      throw InputError("--seconds", 0, "a run of " + sim::time_word(run_us),
                       "at least " + sim::time_word(sim::min_random_run_us) + " for random faults");
    }
    const sim::RandomFaults settings{*seed, run_us, options.chips};
    std::cout << sim::faults_text(sim::random_faults(settings, run.scenario), run.scenario.robot);
  } else if (!options.file.empty()) {
    throw InputError("FILE", 0, in_quotes(options.file) + " without --schedule",
                     "proleg faults FILE --schedule SEED; without FILE the command lists what can fail");
  } else {
    print_kinds(std::cout);
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg faults",
                           "Lists what can be made to fail in a run of proleg hil --faults, or writes a schedule.");
  FaultsOptions options;
  add_scenario(command_line, options.file, "the scenario whose robot a random schedule is for");
  command_line.add_option("--schedule", options.schedule,
                          "SEED: print the random schedule of 'proleg hil FILE --faults SEED', to keep or change it");
  command_line.add_option("--seconds", options.seconds, "length of the run instead of the scenario's");
  command_line.add_flag("--chips", options.chips,
                        "with --schedule: the schedule of a run with --modules mcu, in which clocks fail too");
  command_line.add_option("--recording", options.recording, "RECORDING: print the schedule of a recorded run");
  command_line.add_flag("--markdown", options.markdown, "print the table of docs/faults.md");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return faults(options); });
}
