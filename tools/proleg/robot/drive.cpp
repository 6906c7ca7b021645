// proleg drive: a robot of modules moves as its scenario says.

#include <algorithm>
#include <csignal>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/robot/drive_input.hpp"
#include "tools/proleg/robot/drive_report.hpp"
#include "tools/proleg/robot/gait_run.hpp"
#include "tools/proleg/robot/mirror.hpp"
#include "tools/proleg/robot/robot_control_drive.hpp"
#include "tools/proleg/robot/simulated_transport.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

/// Where the results of a run go; null: not asked for.
struct DriveRecorders {
  sim::Recorder* recorder;
  Mirror* mirror;
  sim::Recorder* mirror_recorder;
};

/// One run: set-up, gait and stop.
class Drive {
 public:
  Drive(const DriveOptions& options, const ScenarioRun& run, BusAccess& bus, DriveInput& input,
        const DriveRecorders& recorders)
      : run_(run),
        is_verbose_(options.verbose),
        input_(input),
        bus_(bus.connection()),
        recorders_(recorders),
        gait_(run.scenario, bus_, {run.ticks}) {}
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  /// Throws std::runtime_error if the robot cannot be started. Nothing has moved then.
  void start() {
    constexpr Microseconds at_most = 60'000'000;  // the master gives up by itself; this bounds a master with a fault
    gait_.start();
    bus_.run_until(bus_.now() + at_most, [this] {
      report_events();
      return gait_.state() == canopen::MasterState::running || gait_.state() == canopen::MasterState::failed ||
             interrupted() || input_.has_ended() || input_.is_silent() || !bus_.state().is_connected;
    });
    if (gait_.state() == canopen::MasterState::running) {
      gait_.watch();
      return;
    }
    const std::string reason = interrupted()        ? "interrupted"
                               : input_.has_ended() ? "standard input has ended"
                               : input_.is_silent() ? silent_input
                                                    : gait_.why_ended();
    const bool is_bad_input = gait_.has_bad_setup();
    static_cast<void>(stop());
    if (is_bad_input) {
      throw BadInput(run_.scenario.path + ": " + reason);
    }
    throw std::runtime_error(reason);
  }

  /// Follows the run to its end, or until the user ends it. Throws std::runtime_error if the robot fails.
  void follow() {
    RunProgress progress("driving", run_.scenario.duration_s);
    while (check().ticks() < run_.ticks && !wants_stop()) {
      bus_.run_until(bus_.now() + look_period_us, [this] { return gait_.has_ended(); });
      report_events();
      take_ticks(false);
      take_input();
      gait_.release_changes();
      progress.show(check().ticks() * (run_.scenario.kernel.tick_period_us * 1e-6));
      if (gait_.has_ended()) {
        throw std::runtime_error(gait_.why_ended());
      }
    }
    if (!wants_stop()) {
      look_at_the_joints();
    }
  }

  /// Ramps down and takes the power from the servos. Whether all modules have confirmed it.
  bool stop() {
    gait_.stop();
    for (bool has_stopped = false; !has_stopped;) {
      bus_.run_until(bus_.now() + look_period_us, [this, &has_stopped] {
        report_events();
        return has_stopped = gait_.has_stopped();
      });
      try_to_take_ticks(has_stopped);
    }
    gait_.compare_setpoints();
    return gait_.are_all_off();
  }

  [[nodiscard]] const GaitCheck& check() const { return gait_.check(); }
  [[nodiscard]] DriveResult result() const {
    return {check().ticks(),
            gait_.drive().master().restarts(),
            gait_.changes().dropped() + gait_.changes().unfinished(),
            bus_.statistics(),
            gait_.answers_us(),
            gait_.change_times().acknowledged_us(),
            gait_.change_times().ticks_to_effect()};
  }

 private:
  static constexpr Microseconds look_period_us = 20'000;
  static constexpr const char* silent_input =
      "no line on standard input for too long: the program that started this one is suspended, or hangs";

  /// Looks at the joints at the end of a run: one that has just lost its gait must not pass as one that has followed
  /// it.
  void look_at_the_joints() {
    constexpr Microseconds at_most = 1'000'000;
    gait_.gait_watch().look_at_all();
    bus_.run_until(bus_.now() + at_most,
                   [this] { return gait_.gait_watch().has_looked() || gait_.has_ended() || interrupted(); });
    report_events();
    if (gait_.has_ended()) {
      throw std::runtime_error(gait_.why_ended());
    }
  }

  void report_events() {
    gait_.report_events(is_verbose_, [](const std::string& line) { std::cerr << "proleg drive: " << line << '\n'; });
  }

  /// While the robot stops: a failure of the mirror or a recorder does not end that.
  void try_to_take_ticks(bool at_end) {
    try {
      take_ticks(at_end);
    } catch (const std::exception& error) {
      std::cerr << "proleg drive: " << error.what() << '\n';
    }
  }

  void take_ticks(bool at_end) {
    gait_.take_ticks(
        at_end, {.tick = [this](const Change* change) { record(change); },
                 .measured =
                     [this](const host::Measurement& measured) {
                       if (recorders_.mirror != nullptr && measured.values.angle != canopen::Monitoring::not_measured) {
                         recorders_.mirror->note_measured(measured.tick, measured.joint, radians(measured.values));
                       }
                     }});
  }

  /// The last tick that was followed.
  void record(const Change* change) {
    if (recorders_.recorder == nullptr && recorders_.mirror == nullptr) {
      return;
    }
    const sim::TickSample sample = gait_.check().sample(gait_.drive());
    record_into(recorders_.recorder, change, sample);
    if (recorders_.mirror != nullptr) {
      record_into(recorders_.mirror_recorder, change, recorders_.mirror->follow(sample));
    }
  }
  static void record_into(sim::Recorder* recorder, const Change* change, const sim::TickSample& sample) {
    if (recorder == nullptr) {
      return;
    }
    if (change != nullptr) {
      recorder->record_change(*change);
    }
    recorder->record_tick(sample);
  }

  [[nodiscard]] bool wants_stop() const { return interrupted() || is_stop_typed_ || input_.has_ended(); }

  void take_input() {
    if (input_.is_silent()) {
      throw std::runtime_error(silent_input);
    }
    constexpr int most_lines = 1'000;  // input without an end must not keep this program from its robot
    for (int i = 0; i < most_lines; ++i) {
      const std::optional<std::string> line = input_.next();
      if (!line) {
        return;
      }
      const std::string word(trimmed(*line));
      if (word == "stop" || word == "quit") {
        is_stop_typed_ = true;
      } else if (!word.empty()) {
        try {
          gait_.add_change(word);
        } catch (const InputError& error) {
          std::cerr << "proleg drive: " << error.what() << '\n';
        }
      }
    }
  }

  const ScenarioRun& run_;
  bool is_verbose_;
  DriveInput& input_;
  host::BusConnection& bus_;
  DriveRecorders recorders_;
  GaitRun gait_;
  bool is_stop_typed_ = false;
};

sim::Scenario scenario_of(const host::BusAddress& simulation) {
  ScenarioOptions robot;
  robot.file = simulation.name;
  return prepare_run(robot).scenario;
}

/// The scenario of --bus sim:FILE, for --fast. Throws InputError for another bus.
sim::Scenario simulated_robot(const BusOptions& bus) {
  const host::BusAddress address = host::parse_bus_address(bus.address());
  if (address.kind != host::BusAddress::Kind::simulation) {
    throw InputError("--fast", 0, "the bus " + in_quotes(bus.address()), "--bus sim:FILE: no other robot is faster");
  }
  return scenario_of(address);
}

/// Throws InputError for what is known to be wrong before the bus is opened.
int check_bus(const DriveOptions& options) {
  const host::BusAddress address = host::parse_bus_address(options.bus.address());
  if (address.kind == host::BusAddress::Kind::simulation) {
    static_cast<void>(scenario_of(address));
  }
  if (options.json) {
    std::cout << Json{{"bus", host::bus_address_text(address)}}.text() << '\n';
  }
  return exit_success;
}

int drive(const DriveOptions& options) {
  ScenarioRun run = prepare_run(options);
  print_warnings("proleg drive", run.scenario);
  const bool has_modules = !run.scenario.robot_control || options.bus.bus;
  sim::require_sensors(run.scenario, has_modules ? sim::sensors_of_modules : std::uint8_t{0},
                       has_modules ? "a module" : "a robot without modules");
  if (options.verbose) {
    print_setup(run.scenario);
  }
  refuse_world_options(options, {{"--losses", options.losses.has_value()}});
  DriveInput input(options.ends_with_input, options.longest_silence);
  if (options.only_checks) {
    return check_bus(options);
  }
  if (run.scenario.robot_control && !options.bus.bus) {
    if (options.fast || options.mirror || options.ends_with_input || options.longest_silence) {
      throw InputError(options.fast              ? "--fast"
                       : options.mirror          ? "--mirror"
                       : options.ends_with_input ? "--until-input-ends"
                                                 : "--longest-silence",
                       0, "a robot without modules", "--bus BUS");
    }
    return drive_by_plugin(options, run);
  }
  std::vector<PlannedOutput> outputs = planned_recording(options);
  if (options.mirror) {
    std::ranges::copy(MirroredRun::planned(options, *options.mirror), std::back_inserter(outputs));
  }
  check_outputs(outputs);
  const std::optional<sim::Scenario> simulated =
      options.fast ? std::optional(simulated_robot(options.bus)) : std::nullopt;
  const std::optional<std::string> raised_period = fit_servo_period(run.scenario, options.bus.address());
  const auto open_simulated = [&](host::TransportListener& listener) {
    return std::make_unique<SimulatedTransport>(*simulated, options.bus.address(), listener);
  };
  BusAccess bus = simulated ? BusAccess(open_simulated) : BusAccess(options.bus);
  catch_interrupts();
  // A reader of the output that ends must not end this program while the robot moves.
  std::signal(SIGPIPE, SIG_IGN);
  std::unique_ptr<sim::Recorder> recorder = open_recorder(options, run.scenario, "drive");
  std::optional<MirroredRun> mirrored;
  DriveRecorders recorders{recorder.get(), nullptr, nullptr};
  if (options.mirror) {
    mirrored.emplace(options, *options.mirror, run.scenario);
    recorders.mirror = &mirrored->mirror();
    recorders.mirror_recorder = &mirrored->recorder();
  }
  Drive robot(options, run, bus, input, recorders);
  robot.start();
  if (raised_period) {
    print_warning("proleg drive", *raised_period);
  }
  std::optional<std::string> failure;
  try {
    robot.follow();
  } catch (const std::exception& error) {
    failure = error.what();
    // The stop takes some seconds if no module answers.
    std::cerr << "proleg drive: the robot stops: " << *failure << '\n';
  }
  if (!robot.stop()) {
    failure = (failure ? *failure + "; " : std::string()) +
              "not all modules have confirmed that their servos have no power: switch the robot off; modules without a "
              "host stop by themselves within 1.5 s";
  }
  const GaitCheck& check = robot.check();
  const DriveResult result = robot.result();
  const double seconds = static_cast<double>(std::uint64_t{result.ticks} * run.scenario.kernel.tick_period_us) / 1e6;
  try {
    if (recorder) {
      recorder->finish({{"simulated_s", exact_text(seconds)},
                        {"differences", std::to_string(check.differences())},
                        {"frames_missing", std::to_string(check.missing())},
                        {"setpoint_hash", check.setpoint_hash().hex()},
                        {"servo_hash", check.servo_hash().hex()}});
    }
    if (mirrored) {
      mirrored->finish(seconds, check);
    }
  } catch (const std::exception& error) {
    failure = failure.value_or(error.what());
  }
  print_result(options, result, check, seconds, mirrored ? &*mirrored : nullptr);
  if (failure) {
    throw std::runtime_error(*failure + kept_in_recording(options));
  }
  if (result.dropped_changes > 0) {
    std::cerr << "proleg drive: " << result.dropped_changes << (result.dropped_changes == 1 ? " change" : " changes")
              << " did not take effect\n";
    return exit_failed;
  }
  return check.differences() == 0 && check.different_setpoints().empty() ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg drive",
      "Moves a robot of modules as its scenario says: configures the modules, gives the servos power and starts the "
      "gait. Compares every state frame with the gait of this computer; status 1 if one differs. While it runs, type "
      "changes such as amplitude=30 or amplitude:J2=30, or stop. Ctrl-C lets the joints ramp to their safe pose and "
      "takes the power from the servos.");
  DriveOptions options;
  add_scenario_options(command_line, options);
  add_bus_option(command_line, options.bus);
  command_line
      .add_option("--mirror", options.mirror,
                  "simulate the robot beside the real one, record it in this file, and draw the difference of measured "
                  "and simulated angles beside it")
      .value_name("FILE");
  command_line.add_flag("--until-input-ends", options.ends_with_input,
                        "stop the robot when standard input ends, for a program that starts this one: the robot stops "
                        "when that program ends, in any way");
  command_line
      .add_option("--longest-silence", options.longest_silence,
                  "stop the robot when no line has come on standard input for this time; an empty line changes nothing")
      .value_name("SECONDS");
  command_line.add_flag("--fast", options.fast, "with --bus sim:FILE: as fast as this computer simulates");
  command_line.add_flag("--check", options.only_checks,
                        "read FILE, and the scenario of --bus sim:FILE, and end: no bus is opened, and nothing moves");
  command_line.add_locked_algorithms_option();
  return command_line.run(argc, argv, [&] { return drive(options); });
}
