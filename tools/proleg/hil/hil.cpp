// proleg hil: hardware in the loop. The joints' own programs on a simulated CAN bus move the simulated robot.

#include <algorithm>
#include <chrono>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/algorithm_library/guarded_algorithm.hpp"
#include "sim/bus/candump_log.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/hil/hil_faults.hpp"
#include "tools/proleg/hil/hil_modules.hpp"
#include "tools/proleg/hil/hil_options.hpp"
#include "tools/proleg/hil/hil_report.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

void note_restart(const ScenarioRun& run, std::uint32_t tick, const sim::RestartEvent& event,
                  std::vector<RestartReport>& restarts) {
  const std::uint8_t node = run.scenario.modules[event.joint].node;
  if (!event.joined) {
    restarts.push_back({node, run.scenario.robot.joints[event.joint].name, tick, std::nullopt});
    return;
  }
  for (RestartReport& restart : restarts) {
    if (restart.node == node && !restart.joined_tick) {
      restart.joined_tick = tick;
    }
  }
}

/// Records the events of modules that the recording does not have yet.
void record_module_events(const sim::MotionWatch& watch, sim::Recorder& recorder, std::size_t& recorded) {
  for (; recorded < watch.events().size(); ++recorded) {
    const sim::ModuleEvent& event = watch.events()[recorded];
    recorder.record_module_event(static_cast<std::uint64_t>(event.time_s * 1e6), event.joint, event.text);
  }
}

std::vector<sim::RecordedFault> recorded_faults(const sim::FaultSchedule& schedule, const sim::RobotModel& robot) {
  std::vector<sim::RecordedFault> faults;
  for (const sim::Fault& fault : schedule) {
    const auto end_us = fault.duration_us ? std::optional(fault.start_us + *fault.duration_us) : std::nullopt;
    faults.push_back({fault.start_us, end_us, fault.joint, describe(fault, robot)});
  }
  return faults;
}

HilResult run_loop(const ScenarioRun& run, const HilModules& modules, sim::HardwareLoop& loop,
                   sim::Recorder* recorder) {
  RunProgress progress("in the loop", run.scenario.duration_s);
  HilResult result;
  std::size_t recorded_events = 0;
  const auto start = std::chrono::steady_clock::now();
  while (loop.tick() < run.ticks && !interrupted()) {
    const Change* change = loop.advance();
    const std::uint32_t tick = loop.tick() - 1;
    for (const auto& event : loop.restart_events()) {
      note_restart(run, tick, event, result.restarts);
      if (recorder != nullptr) {
        recorder->record_restart(tick, event.joint, event.joined);
      }
    }
    if (recorder != nullptr) {
      if (change != nullptr) {
        recorder->record_change(*change);
      }
      recorder->record_tick(loop.sample());
    }
    if (recorder != nullptr) {
      record_module_events(loop.motion_watch(), *recorder, recorded_events);
    }
    progress.show(loop.time_s());
  }
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.ticks = loop.tick();
  result.simulated_s = loop.time_s();
  result.displacement_m = loop.plant().displacement();
  result.sensors = loop.plant().sensors().summaries();
  result.contacts_mean = loop.plant().mean_contacts();
  result.differences = loop.differences();
  if (const auto& first = loop.first_difference()) {
    result.first_difference = describe(*first, joint_and_node(run, first->joint));
  }
  result.clipped_ticks.assign(loop.clipped_ticks().begin(), loop.clipped_ticks().end());
  result.dropped_changes.assign(loop.dropped_changes().begin(), loop.dropped_changes().end());
  result.failures.assign(loop.failures().begin(), loop.failures().end());
  result.problems.assign(loop.problems().begin(), loop.problems().end());
  result.costliest_tick = modules.costliest_tick();
  result.command_latency_ns = loop.command_latency_ns();
  result.lost_frames = loop.lost_frames();
  result.receptions = loop.receptions();
  const sim::BusStatistics bus = loop.bus_statistics();
  result.frames = bus.frames;
  result.bit_errors = bus.errors;
  result.bus_load = bus.load();
  result.setup_frames = loop.setup_frames();
  result.setpoint_hash = loop.setpoint_hash().hex();
  result.servo_hash = loop.servo_hash().hex();
  result.world_hash = loop.world_hash();
  result.motion_hash = loop.motion_hash();
  result.measures = measures_of(loop.plant().meter());
  loop.finish_watch();
  const sim::MotionWatch& watch = loop.motion_watch();
  result.first_fault_tick = loop.first_fault_tick();
  result.module_events = watch.events();
  result.joint_ends = watch.ends();
  result.violations = watch.violations();
  result.worst_motion = watch.worst();
  return result;
}

/// The files that the run writes while it runs.
struct HilFiles {
  std::unique_ptr<sim::Recorder> recorder;
  std::unique_ptr<sim::CandumpLog> log;
};

/// A campaign has many runs, and writes a file of none.
void refuse_files_of_one_run(const HilOptions& options) {
  const struct {
    const char* name;
    bool is_given;
  } of_one_run[]{{"--record", options.record.has_value()},
                 {"--can-log", options.can_log.has_value()},
                 {"--trace", !options.traces.empty()}};
  for (const auto& option : of_one_run) {
    if (option.is_given) {
      throw InputError(option.name, 0, "--faults SEED:COUNT, too",
                       "one run: 'proleg faults FILE --schedule SEED' prints the schedule of a seed for --faults");
    }
  }
}

void check_files(const HilOptions& options, const HilModules& modules) {
  std::vector<PlannedOutput> outputs = planned_recording(options);
  if (options.can_log) {
    outputs.push_back({"--can-log", *options.can_log, "CAN log", starts_with(std::string(1, sim::candump_log_start))});
  }
  std::ranges::move(modules.planned_traces(), std::back_inserter(outputs));
  check_outputs(outputs);
}

/// Opens the files before the run. Throws BadInput.
void open_files(const HilOptions& options, const ScenarioRun& run, HilModules& modules, HilFiles& files) {
  files.recorder = open_recorder(options, run.scenario, "hil " + modules.kind());
  if (options.can_log) {
    try {
      files.log = std::make_unique<sim::CandumpLog>(*options.can_log);
    } catch (const sim::CandumpLogError& error) {
      throw BadInput(error.what());
    }
  }
  modules.open_traces();
}

/// The exit status of a run that came to its end; prints the reason of a failure.
int judge(const HilResult& result, std::uint32_t tick_period_us) {
  if (result.differences > 0) {
    std::cerr << "proleg hil: " << result.first_difference << '\n';
    return exit_failed;
  }
  if (!result.faults.empty()) {
    for (const std::string& violation : result.violations) {
      std::cerr << "proleg hil: " << violation << '\n';
    }
    return result.violations.empty() ? exit_success : exit_failed;
  }
  if (!result.dropped_changes.empty()) {
    std::cerr << "proleg hil: " << result.dropped_changes.size() << " changes did not take effect, those for the ticks "
              << list_dropped_changes(result) << '\n';
    return exit_failed;
  }
  // The duration of the start does not depend on the tick; the set-up sends some frames in each tick.
  constexpr std::uint32_t second_us = 1'000'000;
  const std::uint32_t max_ticks_to_join = std::max<std::uint32_t>(100, second_us / tick_period_us);
  for (const RestartReport& restart : result.restarts) {
    if (!restart.joined_tick) {
      const std::uint32_t ticks = result.ticks - restart.tick;
      const std::string text = "node " + std::to_string(restart.node) + " (" + restart.joint +
                               ") had not joined again when the run ended, " + std::to_string(ticks) +
                               " ticks after its reset";
      if (ticks >= max_ticks_to_join) {
        std::cerr << "proleg hil: " << text << '\n';
        return exit_failed;
      }
      print_warning("proleg hil", text);
    }
  }
  return exit_success;
}

int hil(const HilOptions& options) {
  const ScenarioRun run = prepare_run(options);
  print_warnings("proleg hil", run.scenario);
  sim::require_sensors(run.scenario, sim::sensors_of_modules, "a module");
  if (options.verbose) {
    print_setup(run.scenario);
  }
  sim::HardwareOptions hardware = hardware_options(options, run);
  hardware.notice = [](const std::string& text) { std::cerr << "proleg hil: " << text << '\n'; };
  HilModules modules(options, run.scenario);
  FaultPlan plan = read_fault_plan(options, run, modules.any_virtual());
  if (plan.runs) {
    refuse_files_of_one_run(options);
    modules.flash("proleg hil");
    catch_interrupts();
    return run_fault_campaign(options, run, modules, plan);
  }
  warn_of_faults_without_effect(plan.schedule, run, modules);
  hardware.faults = plan.schedule;
  check_files(options, modules);
  modules.flash("proleg hil");
  hardware.start_time_us = modules.start_time_us();
  HilFiles files;
  if (options.can_log) {
    hardware.on_frame = [&files](const sim::Transmission& transmission) {
      files.log->write(transmission.end, transmission.frame);
    };
  }
  hardware.make_module = [&modules](const sim::ModuleParts& parts) { return modules.make(parts); };
  hardware.threads = modules.threads();
  hardware.before_start = [&] {
    open_files(options, run, modules, files);
    if (files.recorder) {
      files.recorder->record_faults(recorded_faults(plan.schedule, run.scenario.robot));
    }
    catch_interrupts();
  };
  std::optional<HilResult> finished;
  try {
    sim::HardwareLoop loop(run.scenario, std::move(hardware));
    finished = run_loop(run, modules, loop, files.recorder.get());
  } catch (const sim::PhysicsError& error) {
    throw std::runtime_error(error.what() + kept_in_recording(options));
  } catch (const AlgorithmFailure& error) {
    throw std::runtime_error(error.what() + kept_in_recording(options));
  }
  finished->faults = std::move(plan.schedule);
  const HilResult& result = *finished;
  if (files.log) {
    files.log->finish();
  }
  if (interrupted()) {
    std::cerr << "proleg hil: interrupted after " << result.simulated_s << " s" << kept_in_recording(options) << '\n';
    return exit_failed;
  }
  if (files.recorder) {
    files.recorder->finish(hil_summary(run, result));
  }
  if (options.json) {
    std::cout << hil_json(options, run, modules, result).text() << '\n';
  } else {
    print_hil_table(options, run, modules, result);
  }
  std::cout.flush();
  print_warning_on_servos("proleg hil", result.measures, run.scenario.robot);
  print_warning_on_clipping("proleg hil", run.scenario, result.clipped_ticks, result.ticks);
  modules.finish();
  return judge(result, run.scenario.kernel.tick_period_us);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg hil",
      "Hardware in the loop: the joints' own programs on a simulated CAN bus move the simulated robot. Compares every "
      "set-point and servo command with the same gait computed in memory; status 1 if one differs.");
  HilOptions options;
  add_hil_options(command_line, options);
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return hil(options); });
}
