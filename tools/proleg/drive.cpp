// proleg drive: a robot of modules moves as its scenario says.

#include <algorithm>
#include <csignal>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/answer_times.hpp"
#include "host/robot/change_times.hpp"
#include "host/robot/gait_watch.hpp"
#include "host/robot/robot_drive.hpp"
#include "host/robot/sdo_queue.hpp"
#include "host/robot/session_token.hpp"
#include "host/robot/state_text.hpp"
#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/master_text/master_text.hpp"
#include "shared/computer/output/output_check.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/scenario/master_input.hpp"
#include "tools/proleg/bus_access.hpp"
#include "tools/proleg/drive_plugin.hpp"
#include "tools/proleg/drive_report.hpp"
#include "tools/proleg/gait_check.hpp"
#include "tools/proleg/input_lines.hpp"
#include "tools/proleg/live_changes.hpp"
#include "tools/proleg/mirrored_run.hpp"
#include "tools/proleg/run_progress.hpp"
#include "tools/proleg/scenario_run.hpp"
#include "tools/proleg/simulated_transport.hpp"

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
  Drive(const DriveOptions& options, const ScenarioRun& run, BusAccess& bus, const DriveRecorders& recorders)
      : run_(run),
        is_verbose_(options.verbose),
        bus_(bus.connection()),
        recorders_(recorders),
        input_(run.scenario),
        changes_(run.scenario, std::move(input_.changes)),
        drive_(bus_, input_.setup, master_options(), changes_.span()),
        gait_watch_(bus_, {input_.setup.nodes.begin(), input_.setup.nodes.end()}),
        check_(run.scenario),
        end_tick_(run.ticks) {
    bus_.attach(answer_times_);  // before the master: it answers an answer with the next request
    bus_.attach(change_times_);
    bus_.attach(drive_);
    bus_.attach(gait_watch_);
  }
  ~Drive() {
    bus_.detach(drive_);
    bus_.detach(gait_watch_);
    bus_.detach(answer_times_);
    bus_.detach(change_times_);
  }
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  /// Throws std::runtime_error if the robot cannot be started. Nothing has moved then.
  void start() {
    constexpr Microseconds at_most = 60'000'000;  // the master gives up by itself; this bounds a master with a fault
    drive_.master().start(bus_.now());
    bus_.run_until(bus_.now() + at_most, [this] {
      report_events();
      return state() == canopen::MasterState::running || state() == canopen::MasterState::failed || interrupted() ||
             !bus_.state().is_connected;
    });
    if (state() == canopen::MasterState::running) {
      gait_watch_.start(bus_.now());
      return;
    }
    const std::string reason = interrupted() ? "interrupted" : why_not();
    static_cast<void>(stop());
    throw std::runtime_error(reason);
  }

  /// Until the end of the run, or until the user ends it. Throws std::runtime_error if the robot fails.
  void follow() {
    RunProgress progress("driving", run_.scenario.duration_s);
    while (check_.ticks() < run_.ticks && !interrupted() && !wants_stop_) {
      bus_.run_until(bus_.now() + look_period_us, [this] { return has_ended(); });
      report_events();
      take_ticks(false);
      take_input();
      release_changes();
      progress.show(check_.ticks() * (run_.scenario.kernel.tick_period_us * 1e-6));
      if (has_ended()) {
        throw std::runtime_error(why_not());
      }
    }
    if (!interrupted() && !wants_stop_) {
      look_at_the_joints();
    }
  }

  /// Ramps down and takes the power from the servos. Whether all modules have confirmed it.
  bool stop() {
    // The master gives up by itself: silent modules cost it a second for every eight of them.
    constexpr Microseconds at_most = 20'000'000;
    are_all_off_ = true;
    gait_watch_.stop();
    // What the modules send while they stop is not part of the gait.
    end_tick_ = std::min(end_tick_, drive_.master().tick().value_or(0));
    drive_.master().stop(bus_.now());
    bool is_stopped = false;
    for (const Microseconds end = bus_.now() + at_most; !is_stopped && bus_.now() < end;) {
      is_stopped = bus_.run_until(std::min(end, bus_.now() + look_period_us), [this] {
        report_events();
        return state() == canopen::MasterState::stopped;
      });
      try_to_take_ticks(is_stopped);
    }
    if (is_following_) {
      for (unsigned joint = 0; joint < run_.scenario.modules.size(); ++joint) {
        check_.compare_setpoints(joint, drive_.master().checksum(joint));
      }
    }
    return are_all_off_ && state() == canopen::MasterState::stopped;
  }

  [[nodiscard]] const GaitCheck& check() const { return check_; }
  [[nodiscard]] DriveResult result() const {
    return {check_.ticks(),
            drive_.master().restarts(),
            changes_.dropped() + changes_.unfinished(),
            bus_.statistics(),
            answer_times_.microseconds(),
            change_times_.acknowledged_us(),
            change_times_.ticks_to_effect()};
  }

 private:
  static constexpr Microseconds look_period_us = 20'000;
  static constexpr std::uint16_t ramp_in_speed = 90;  // degrees a second, as in a quick stop

  [[nodiscard]] canopen::MasterOptions master_options() const {
    canopen::MasterOptions options;
    options.core_fingerprint = core_fingerprint;
    options.serials = input_.serials;
    options.resets_modules = true;
    options.ramps_down = true;
    options.reads_checksums = true;
    options.ramp_in_speed = ramp_in_speed;
    options.session_token = host::random_token();
    options.answer_timeout_us = host::patient_timeout_us;
    options.attempts = host::patient_attempts;
    return options;
  }
  [[nodiscard]] canopen::MasterState state() const { return drive_.master().state(); }
  [[nodiscard]] bool has_ended() const {
    return state() == canopen::MasterState::failed || !bus_.state().is_connected || gait_watch_.loss();
  }
  /// At the end of a run: a joint that has just lost its gait must not pass as one that has followed it.
  void look_at_the_joints() {
    constexpr Microseconds at_most = 1'000'000;
    gait_watch_.look_at_all();
    bus_.run_until(bus_.now() + at_most, [this] { return gait_watch_.has_looked() || has_ended() || interrupted(); });
    report_events();
    if (has_ended()) {
      throw std::runtime_error(why_not());
    }
  }
  [[nodiscard]] std::string name_of(std::uint8_t node) const { return sim::name_of_node(run_.scenario, node); }

  [[nodiscard]] std::string why_not() const {
    using canopen::ProblemCode;
    const canopen::Problem& problem = drive_.master().problem();
    if (!bus_.state().is_connected) {
      return bus_.diagnosis();
    }
    if (const auto& loss = gait_watch_.loss(); loss && state() != canopen::MasterState::failed) {
      return text_of(*loss);
    }
    if (problem.code == ProblemCode::none) {
      return "the set-up has not ended in time; " + bus_.diagnosis();
    }
    std::string text = problem_text(problem, [this](std::uint8_t node) { return name_of(node); });
    if (problem.code == ProblemCode::missing_module || problem.code == ProblemCode::cannot_send ||
        problem.code == ProblemCode::no_answer) {
      text += "; " + bus_.diagnosis();
    }
    return text;
  }

  [[nodiscard]] std::string text_of(const host::GaitWatch::Loss& loss) const {
    using Reason = host::GaitWatch::Reason;
    const std::string what = loss.reason == Reason::drive ? std::string(host::drive_text(loss.statusword))
                             : loss.reason == Reason::mode
                                 ? "its mode is " + std::to_string(loss.mode) + ", expected -1 (gait)"
                                 : "its module is " + std::string(host::state_text(loss.state));
    const std::string text = name_of(loss.node) + " does not follow the gait any more: " + what;
    return text + (loss.emergency == canopen::EmergencyCode::none
                       ? "; another program may have done that"
                       : "; the module has reported: " + std::string(canopen::describe(loss.emergency)));
  }

  void report_events() {
    while (const auto event = drive_.master().take_event()) {
      const bool is_news = event->kind != canopen::EventKind::emergency || event->code != canopen::EmergencyCode::none;
      if (is_news || is_verbose_) {
        std::cerr << "proleg drive: " << event_text(*event, [this](std::uint8_t node) { return name_of(node); })
                  << '\n';
      }
      are_all_off_ = are_all_off_ && event->kind != canopen::EventKind::not_stopped;
      if (event->kind == canopen::EventKind::rejoined || event->kind == canopen::EventKind::rejoin_failed) {
        gait_watch_.return_to_gait(event->node);
      }
      if (event->kind == canopen::EventKind::restarted) {
        check_.end_comparison(name_of(event->node) + " has restarted");
      }
    }
  }

  /// While the robot stops: a failure of the mirror or a recorder does not end that.
  void try_to_take_ticks(bool at_end) {
    try {
      if (is_following_) {
        take_ticks(at_end);
      }
    } catch (const std::exception& error) {
      std::cerr << "proleg drive: " << error.what() << '\n';
    }
  }

  void take_ticks(bool at_end) {
    is_following_ = false;  // if the mirror or a recorder fails, it does not work for the rest either
    while (auto tick = drive_.take_tick(at_end)) {
      for (const sim::Change& change : changes_.take_decided(tick->tick)) {
        check_.add_change(change);
      }
      if (check_.ticks() >= end_tick_) {
        check_.follow_stopping(*tick);
        continue;
      }
      const sim::Change* change = check_.follow(*tick);
      record(change);
    }
    while (const auto measured = drive_.take_measurement()) {
      if (recorders_.mirror != nullptr && measured->values.angle != canopen::Monitoring::not_measured) {
        recorders_.mirror->note_measured(measured->tick, measured->joint, radians(measured->values));
      }
    }
    is_following_ = true;
  }

  /// The last tick that was followed.
  void record(const sim::Change* change) {
    if (recorders_.recorder == nullptr && recorders_.mirror == nullptr) {
      return;
    }
    const sim::TickSample sample = check_.sample(drive_);
    record_into(recorders_.recorder, change, sample);
    if (recorders_.mirror != nullptr) {
      record_into(recorders_.mirror_recorder, change, recorders_.mirror->follow(sample));
    }
  }
  static void record_into(sim::Recorder* recorder, const sim::Change* change, const sim::TickSample& sample) {
    if (recorder == nullptr) {
      return;
    }
    if (change != nullptr) {
      recorder->record_change(*change);
    }
    recorder->record_tick(sample);
  }

  /// Throws InputError.
  void add_change(const std::string& word) {
    const std::uint32_t tick = drive_.master().tick().value_or(0);
    if (!changes_.add(word, tick, run_.ticks)) {
      return;
    }
    const std::span<canopen::Change> changes = changes_.span();
    if (changes.back().tick == canopen::Change::soon) {
      change_times_.accepted(changes.size() - 1, bus_.now(), tick);
    }
    give_changes(word);
  }

  /// To the master: those that are behind the ones that it has. what: the last one. Throws InputError.
  void give_changes(const std::string& what) {
    if (!drive_.master().extend_changes(bus_.now(), changes_.span())) {
      changes_.remove_last();
      static_cast<void>(drive_.master().extend_changes(bus_.now(), changes_.span()));
      throw InputError(what, 0, "a change that is not later than the one before it, or has too many values",
                       "a later tick");
    }
  }

  /// The changes of the scenario whose time has come.
  void release_changes() {
    while (changes_.release(drive_.master().tick().value_or(0))) {
      give_changes("the change for tick " + std::to_string(changes_.span().back().tick));
    }
  }

  void take_input() {
    while (const auto line = input_lines_.next()) {
      const std::string word(trimmed(*line));
      if (word == "stop" || word == "quit") {
        wants_stop_ = true;
      } else if (!word.empty()) {
        try {
          add_change(word);
        } catch (const InputError& error) {
          std::cerr << "proleg drive: " << error.what() << '\n';
        }
      }
    }
  }

  const ScenarioRun& run_;
  bool is_verbose_;
  host::BusConnection& bus_;
  DriveRecorders recorders_;
  sim::MasterInput input_;
  LiveChanges changes_;
  host::RobotDrive drive_;
  host::AnswerTimes answer_times_;
  host::ChangeTimes change_times_;
  host::GaitWatch gait_watch_;
  GaitCheck check_;
  InputLines input_lines_;
  bool wants_stop_ = false;
  bool is_following_ = true;  ///< the mirror and the recorders have not failed
  bool are_all_off_ = true;   ///< since stop()
  std::uint32_t end_tick_;    ///< the first one that is not part of the run
};

void refuse_what_only_a_simulation_has(const DriveOptions& options) {
  const std::pair<const char*, bool> given[] = {{"--losses", options.losses.has_value()},
                                                {"--friction", options.overrides.friction.has_value()},
                                                {"--at", options.overrides.at.has_value()},
                                                {"--heading", options.overrides.heading.has_value()}};
  for (const auto& [option, is_given] : given) {
    if (is_given) {
      throw InputError(option, 0, "an option for simulated worlds", "none of them: the robot is where it is");
    }
  }
}

/// The scenario of --bus sim:FILE, for --fast. Throws InputError for another bus.
sim::Scenario simulated_robot(const BusOptions& bus) {
  const host::BusAddress address = host::parse_bus_address(bus.address());
  if (address.kind != host::BusAddress::Kind::simulation) {
    throw InputError("--fast", 0, "the bus " + in_quotes(bus.address()), "--bus sim:FILE: no other robot is faster");
  }
  ScenarioOptions robot;
  robot.file = address.name;
  return prepare_run(robot).scenario;
}

int drive(const DriveOptions& options) {
  const ScenarioRun run = prepare_run(options);
  print_warnings("proleg drive", run.scenario);
  if (options.verbose) {
    print_setup(run.scenario);
  }
  refuse_what_only_a_simulation_has(options);
  if (run.scenario.robot_control && !options.bus.bus) {
    if (options.fast || options.mirror) {
      throw InputError(options.fast ? "--fast" : "--mirror", 0, "a robot without modules", "--bus BUS");
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
  Drive robot(options, run, bus, recorders);
  robot.start();
  std::optional<std::string> failure;
  try {
    robot.follow();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (!robot.stop() && !failure) {
    failure = "not all modules have confirmed that their servos have no power: switch the robot off";
  }
  const GaitCheck& check = robot.check();
  const DriveResult result = robot.result();
  const double seconds = static_cast<double>(std::uint64_t{result.ticks} * run.scenario.kernel.tick_period_us) / 1e6;
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
  print_result(options, result, check, seconds, mirrored ? &*mirrored : nullptr);
  if (failure) {
    throw std::runtime_error(*failure + "; modules without a host stop by themselves within 1.5 s" +
                             kept_in_recording(options));
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
  command_line.add_flag("--fast", options.fast, "with --bus sim:FILE: as fast as this computer simulates");
  return command_line.run(argc, argv, [&] { return drive(options); });
}
