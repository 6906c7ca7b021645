#include "tools/proleg/run/simulation_texts.hpp"

#include <optional>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/run_measures.hpp"

namespace proleg::tools {

std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                             const std::vector<std::string>& settings, const std::vector<std::string>& moves) {
  std::string command = "proleg simulate " + shell_argument(file) + algorithm_options();
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& argument = overrides.*declaration.word) {
      command += " --" + std::string(declaration.name) + ' ' + shell_argument(*argument);
    }
  }
  for (const std::string& argument : settings) {
    command += " --set " + shell_argument(argument);
  }
  for (const std::string& argument : moves) {
    command += " --move " + shell_argument(argument);
  }
  return command;
}

std::vector<std::pair<std::string, std::string>> results_of(const sim::Simulation& simulation,
                                                            const sim::Scenario& scenario, std::uint64_t lost_frames) {
  const sim::Plant& plant = simulation.plant();
  std::vector<std::pair<std::string, std::string>> results{
      {"displacement_m", exact_text(plant.displacement())},
      {"simulated_s", exact_text(simulation.time_s())},
      {"contacts_mean", exact_text(plant.mean_contacts())},
      {"solver_messages", std::to_string(plant.world().solver_messages())},
      {"lost_frames", std::to_string(lost_frames)},
      {"setpoint_hash", simulation.setpoint_hash().hex()},
      {"servo_hash", simulation.servo_hash().hex()}};
  if (const std::optional<std::string> hash = simulation.world_hash()) {
    results.emplace_back("world_hash", *hash);
  }
  results.emplace_back("motion_hash", simulation.motion_hash());
  append_results(measures_of(plant.meter()), scenario.robot, results);
  append_sensors(plant.sensors().summaries(), results);
  return results;
}

}  // namespace proleg::tools
