// proleg simulate: runs a scenario in the physics simulation.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "shared/computer/algorithm_library/guarded_algorithm.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/ode/ode_world.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/run/simulation_texts.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct Result {
  double displacement_m;
  double simulated_s;
  double wall_s;
  double processor_s;  ///< of all threads
  double contacts_mean;
  std::size_t solver_messages;
  std::uint64_t lost_frames;
  std::uint64_t receptions;
  std::string setpoint_hash;
  std::string servo_hash;
  std::optional<std::string> world_hash;
  std::string motion_hash;
  RunMeasures measures;

  [[nodiscard]] double real_time_factor() const { return simulated_s / wall_s; }
};

Result run(const ScenarioRun& setup, sim::Simulation& simulation, sim::Recorder* recorder) {
  RunProgress progress("simulating", setup.scenario.duration_s);
  std::uint64_t lost_frames = 0;
  std::uint64_t receptions = 0;
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  while (simulation.tick() < setup.ticks && !interrupted()) {
    const Change* change = simulation.advance();
    lost_frames += simulation.chain().lost().size();
    receptions += simulation.chain().receptions();
    if (recorder != nullptr) {
      if (change != nullptr) {
        recorder->record_change(*change);
      }
      recorder->record_tick(simulation.sample());
    }
    progress.show(simulation.time_s());
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {simulation.plant().displacement(),
          simulation.time_s(),
          wall_s,
          static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC,
          simulation.plant().mean_contacts(),
          simulation.plant().world().solver_messages(),
          lost_frames,
          receptions,
          simulation.setpoint_hash().hex(),
          simulation.servo_hash().hex(),
          simulation.world_hash(),
          simulation.motion_hash(),
          measures_of(simulation.plant().meter())};
}

void print_json(const ScenarioOptions& options, const ScenarioRun& setup, const Result& result,
                const std::vector<sim::SensorSummary>& sensors) {
  const Json object{{"scenario", options.file},
                    {"seed", setup.scenario.kernel.seed},
                    {"overrides", overrides_object(setup.scenario.overrides)},
                    {"displacement_m", result.displacement_m},
                    {"simulated_s", result.simulated_s},
                    {"setpoint_hash", result.setpoint_hash},
                    {"servo_hash", result.servo_hash},
                    {"world_hash", result.world_hash},
                    {"motion_hash", result.motion_hash},
                    {"real_time_factor", result.real_time_factor()},
                    {"contacts_mean", result.contacts_mean},
                    {"solver_messages", result.solver_messages},
                    {"lost_frames", result.lost_frames},
                    {"frame_receptions", result.receptions},
                    {"measures", measures_object(result.measures.values)},
                    {"link_duty_factors", result.measures.link_duty_factors},
                    {"servos", servos_array(result.measures, setup.scenario.robot)},
                    {"sensors", sensors_array(sensors)},
                    {"recording", options.record.value_or("")},
                    {"build_id", build_id}};
  std::cout << object.text() << '\n';
}

void print_table(const ScenarioOptions& options, const Result& result, const std::vector<sim::SensorSummary>& sensors) {
  std::printf("displacement      %.4f m in %.2f s\n", result.displacement_m, result.simulated_s);
  std::printf("real-time factor  %.1f\n", result.real_time_factor());
  std::printf("contacts          %.2f points in a physics step on average\n", result.contacts_mean);
  if (result.solver_messages > 0) {
    std::printf("solver messages   %zu; --verbose shows the first ones\n", result.solver_messages);
  }
  if (options.losses) {
    std::printf("lost frames       %s\n", losses_text(result.lost_frames, result.receptions).c_str());
  }
  print_hashes(result.setpoint_hash, result.servo_hash, result.world_hash, result.motion_hash);
  if (options.record) {
    std::printf("recording         %s\n", options.record->c_str());
  }
  print_measures(result.measures.values, options.all_measures);
  print_sensors(sensors);
}

/// Says that contacts make a run slow, also on a computer that does nothing else, or less exact.
void print_warning_on_contacts(const sim::Plant& plant, const Result& result) {
  constexpr double many = 40;
  const std::string points = number_text(std::round(plant.mean_contacts())) + " contact points on average";
  if (const std::size_t relieved = sim::relieved_steps(plant.world()); relieved > 0) {
    print_warning("proleg simulate", "links and floor had " + points + ": too many for the direct stepper in " +
                                         std::to_string(relieved) +
                                         " steps, which the iterative one computed. <solver>direct</solver> in the "
                                         "scenario takes the direct one always, and is slow");
  } else if (result.processor_s > result.simulated_s && plant.mean_contacts() > many) {
    print_warning("proleg simulate", "slower than real time, because links and floor had " + points +
                                         "; fewer shapes that touch each other are faster");
  }
}

int simulate(const ScenarioOptions& options) {
  const ScenarioRun setup = prepare_run(options);
  print_warnings("proleg simulate", setup.scenario);
  if (options.verbose) {
    print_setup(setup.scenario);
  }
  check_outputs(planned_recording(options));
  sim::Simulation simulation(setup.scenario, &setup.losses);  // made before any file because it may refuse the scenario
  const std::unique_ptr<sim::Recorder> recorder = open_recorder(options, setup.scenario, "simulate");
  catch_interrupts();
  std::optional<Result> finished;
  try {
    finished = run(setup, simulation, recorder.get());
  } catch (const sim::PhysicsError& error) {
    throw std::runtime_error(error.what() + kept_in_recording(options));
  } catch (const AlgorithmFailure& error) {
    throw std::runtime_error(error.what() + kept_in_recording(options));
  }
  const Result& result = *finished;
  if (options.verbose) {
    for (const std::string& text : simulation.plant().world().solver_message_texts()) {
      std::cerr << "message of the physics engine: " << one_line(text) << '\n';
    }
  }
  if (interrupted()) {
    std::cerr << "proleg simulate: interrupted after " << result.simulated_s << " s" << kept_in_recording(options)
              << '\n';
    return exit_failed;
  }
  if (recorder) {
    recorder->finish(results_of(simulation, setup.scenario, result.lost_frames));
  }
  if (options.json) {
    print_json(options, setup, result, simulation.plant().sensors().summaries());
  } else {
    print_table(options, result, simulation.plant().sensors().summaries());
  }
  print_warning_on_contacts(simulation.plant(), result);
  print_warning_on_servos("proleg simulate", result.measures, setup.scenario.robot);
  print_warning_on_clipping("proleg simulate", setup.scenario, simulation.chain().clipped_ticks(), simulation.tick());
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg simulate", "Runs a scenario in the physics simulation and prints the results.");
  ScenarioOptions options;
  add_scenario_options(command_line, options);
  add_measures_option(command_line, options.all_measures);
  add_move_option(command_line, options);
  command_line.add_locked_algorithms_option();
  return command_line.run(argc, argv, [&] { return simulate(options); });
}
