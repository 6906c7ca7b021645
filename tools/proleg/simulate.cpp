// proleg simulate: runs a scenario in the physics simulation.

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/fixed/decimal.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/text.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/progress.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

std::atomic<bool> interrupted = false;  // lock-free, so a signal handler may set it
static_assert(std::atomic<bool>::is_always_lock_free);

struct Options {
  std::string file;
  std::optional<std::string> seconds;
  std::optional<std::string> record;
  std::vector<std::string> settings;
  bool verbose = false;
  bool json = false;
};

struct Result {
  double displacement_m;
  double simulated_s;
  double wall_s;
  double contacts_mean;
  std::size_t solver_messages;
  std::string setpoint_hash;
  std::string servo_hash;

  [[nodiscard]] double real_time_factor() const { return simulated_s / wall_s; }
};

sim::Scenario prepare(const Options& options) {
  sim::DiskFiles files;
  sim::Scenario scenario = sim::read_scenario(options.file, files);
  for (const std::string& setting : options.settings) {
    sim::apply_setting(scenario, setting);
  }
  if (options.seconds) {
    const std::optional<double> seconds = sim::parse_number(*options.seconds);
    if (!seconds || *seconds < 0.01 || *seconds > 86'400.0) {
      throw sim::InputError("--seconds", 0, sim::in_quotes(*options.seconds), "0.01 to 86400 seconds");
    }
    scenario.duration_s = *seconds;
  }
  return scenario;
}

std::uint32_t tick_count(const sim::Scenario& scenario) {
  const auto ticks =
      static_cast<std::uint32_t>(std::max(1L, std::lround(scenario.duration_s * 1e6 / scenario.kernel.tick_period_us)));
  if (!scenario.changes.empty() && scenario.changes.back().tick >= ticks) {
    throw sim::InputError("--set", 0, "tick " + std::to_string(scenario.changes.back().tick),
                          "a tick before the end of the run, below " + std::to_string(ticks));
  }
  return ticks;
}

/// Every parameter of every joint, as the run starts with it.
void print_setup(const sim::Scenario& scenario, const Kernel& kernel) {
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
      std::cerr << "  " << parameter.name << " [" << scale_of(parameter.unit).symbol << "]";
      for (unsigned joint = 0; joint < kernel.local_joint_count(); ++joint) {
        if (kernel.drives(s, joint)) {
          std::cerr << ' ' << scenario.robot.joints[joint].name << '='
                    << format_decimal(kernel.parameter(s, joint, p), parameter.unit).view();
        }
      }
      std::cerr << '\n';
    }
  }
}

Result run(const sim::Scenario& scenario, std::uint32_t ticks, sim::Recorder* recorder, sim::Simulation& simulation) {
  Progress progress("simulating", "s", scenario.duration_s);
  const auto start = std::chrono::steady_clock::now();
  while (simulation.tick() < ticks && !interrupted) {
    const sim::Change* change = simulation.advance();
    if (recorder != nullptr) {
      if (change != nullptr) {
        recorder->record_change(*change);
      }
      recorder->record_tick(simulation.sample());
    }
    progress.show(simulation.time_s());
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {simulation.displacement(),
          simulation.time_s(),
          wall_s,
          simulation.mean_contacts(),
          simulation.world().solver_messages(),
          simulation.setpoint_hash().hex(),
          simulation.servo_hash().hex()};
}

void print_json(const Options& options, const Result& result) {
  const nlohmann::ordered_json object{{"scenario", options.file},
                                      {"displacement_m", result.displacement_m},
                                      {"simulated_s", result.simulated_s},
                                      {"setpoint_hash", result.setpoint_hash},
                                      {"servo_hash", result.servo_hash},
                                      {"real_time_factor", result.real_time_factor()},
                                      {"contacts_mean", result.contacts_mean},
                                      {"solver_messages", result.solver_messages},
                                      {"recording", options.record.value_or("")},
                                      {"build_id", build_id}};
  // File names need not be UTF-8; whatever is not is replaced.
  std::cout << object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void print_table(const Options& options, const Result& result) {
  std::printf("displacement      %.4f m in %.2f s\n", result.displacement_m, result.simulated_s);
  std::printf("real-time factor  %.1f\n", result.real_time_factor());
  std::printf("contacts          %.2f points in a physics step on average\n", result.contacts_mean);
  if (result.solver_messages > 0) {
    std::printf("solver messages   %zu\n", result.solver_messages);
  }
  std::printf("set-point hash    %s\n", result.setpoint_hash.c_str());
  std::printf("servo hash        %s\n", result.servo_hash.c_str());
  if (options.record) {
    std::printf("recording         %s\n", options.record->c_str());
  }
}

std::string exact(double value) { return nlohmann::json(value).dump(); }

int simulate(const Options& options) {
  const sim::Scenario scenario = prepare(options);
  const std::uint32_t ticks = tick_count(scenario);
  sim::Simulation simulation(scenario);
  if (options.verbose) {
    print_setup(scenario, simulation.kernel());
  }
  std::optional<sim::Recorder> recorder;
  if (options.record) {
    if (options.record->empty()) {
      throw sim::InputError("--record", 0, "no name", "the name of a file");
    }
    try {
      // A link is followed, so that the recording lands where it points to.
      recorder.emplace(std::filesystem::weakly_canonical(*options.record), scenario, build_id);
    } catch (const std::runtime_error& error) {  // RecordError, or a name that leads nowhere
      // Nothing has run yet: it is the name that was wrong.
      std::cerr << "proleg simulate: " << sim::one_line(error.what()) << '\n';
      return exit_bad_input;
    }
  }

  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, [](int) { interrupted = true; });
  }
  const std::string kept = recorder ? "; what was simulated is in " + *options.record : "";
  std::optional<Result> finished;
  try {
    finished = run(scenario, ticks, recorder ? &*recorder : nullptr, simulation);
  } catch (const sim::PhysicsError& error) {
    throw std::runtime_error(error.what() + kept);
  }
  const Result& result = *finished;
  if (interrupted) {
    std::cerr << "proleg simulate: interrupted after " << result.simulated_s << " s" << kept << '\n';
    return exit_failed;
  }
  if (recorder) {
    recorder->finish({{"displacement_m", exact(result.displacement_m)},
                      {"simulated_s", exact(result.simulated_s)},
                      {"contacts_mean", exact(result.contacts_mean)},
                      {"solver_messages", std::to_string(result.solver_messages)},
                      {"setpoint_hash", result.setpoint_hash},
                      {"servo_hash", result.servo_hash}});
  }
  if (options.json) {
    print_json(options, result);
  } else {
    print_table(options, result);
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Runs a scenario in the physics simulation and prints what came of it.", "proleg simulate");
  Options options;
  app.add_option("FILE", options.file, "scenario, a *.simulation.xml file")->required();
  app.add_option("--seconds", options.seconds, "simulated time; the scenario's own duration if not given");
  app.add_option("--record", options.record, "leave a recording (SQLite) in this file");
  app.add_option("--set", options.settings,
                 "NAME=VALUE[@TICK]: change a parameter at the start or at a tick. NAME is [MODULE.]PARAMETER[:JOINT]; "
                 "an internal value may stand in place of the parameter. May be repeated.")
      ->allow_extra_args(false);
  app.add_flag("--verbose", options.verbose, "print the joint map, remarks on the files and all parameters");
  app.add_flag("--json", options.json, "print one JSON object");
  return run_command(argc, argv, app, [&] { return simulate(options); });
}
