// proleg confirm: checks whether a gait is real or depends on an error of the physics.

#include <cstdio>
#include <iostream>
#include <optional>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/confirm/gait_confirmation.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct ConfirmOptions : ScenarioOptions {
  std::string worlds = "50";
};

Json json_of(const optimize::GaitConfirmation& confirmation) {
  Json runs = Json::empty_array();
  for (const optimize::ConfirmedRun& run : confirmation.runs) {
    runs.append({{"name", run.name},
                 {"engine", sim::name_of(run.engine)},
                 {"step_s", run.step_s},
                 {"failure", run.failure},
                 {"distance_m", run.distance},
                 {"first_part_m", run.first_second},
                 {"motors_j", run.energy.motors},
                 {"friction_j", run.energy.friction},
                 {"stored_j", run.energy.stored},
                 {"unexplained_j", run.energy.unexplained},
                 {"gained_j", run.energy_gains}});
  }
  Json findings = Json::empty_array();
  for (const optimize::ConfirmationFinding& finding : confirmation.findings) {
    findings.append(
        {{"name", finding.name}, {"good", finding.was_asked ? Json(finding.is_good) : Json()}, {"text", finding.text}});
  }
  return {{"nothing_speaks_against", confirmation.is_real()},
          {"runs", runs},
          {"worlds_engine", sim::name_of(confirmation.perturbed_engine)},
          {"worlds_m", confirmation.perturbed},
          {"worlds_failed", confirmation.failed_worlds},
          {"findings", findings}};
}

int confirm(const ConfirmOptions& options) {
  const ScenarioRun setup = prepare_run(options);
  const std::optional<std::uint32_t> worlds = parse_whole<std::uint32_t>(options.worlds);
  if (!worlds || *worlds < 1 || *worlds > 10'000) {
    throw InputError("--worlds", 0, in_quotes(options.worlds), "1 to 10000");
  }
  static_cast<void>(sim::Simulation(setup.scenario));  // an engine without the features of the world refuses it now
  print_warnings("proleg confirm", setup.scenario);
  catch_interrupts();
  RunProgress progress("confirming", 1.0);
  optimize::GaitConfirmation confirmation;
  try {
    confirmation = optimize::confirm_gait(setup.scenario, {*worlds, setup.scenario.kernel.seed}, [&](double share) {
      progress.show(share);
      return interrupted();
    });
  } catch (const optimize::SearchEnded&) {
    std::cerr << "proleg confirm: interrupted\n";
    return exit_failed;
  }
  if (options.json) {
    std::cout << json_of(confirmation).text() << '\n';
  } else {
    std::cout << optimize::confirmation_text(confirmation);
  }
  return confirmation.is_real() ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg confirm",
      "Says whether a gait is real or lives on an error of the physics: a finer step, the other "
      "engine, worlds that differ, and where its energy comes from. Exit status 1: it may not be real.");
  ConfirmOptions options;
  add_start_options(command_line, options);
  command_line.add_option("--worlds", options.worlds, "number of worlds that differ").shows_default();
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return confirm(options); });
}
