#include "tools/proleg/search/robot_trials.hpp"

#include <unistd.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "tools/proleg/common/child_program.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/scratch_folder.hpp"
#include "tools/proleg/search/watched_child.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// For the way down and the end of the power: `proleg drive` gives up after 20 s.
constexpr std::chrono::seconds time_to_stop{30};
/// Beside the gait itself, for set-up and stop over a slow bus.
constexpr std::chrono::seconds time_around_gait{120};
/// Far more than it takes to read two scenarios.
constexpr std::chrono::seconds time_to_check{60};

/// Above a line that shows the progress of a search, if there is one.
void print_above_progress(const std::string& line) {
  std::cerr << (isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "") << line << std::endl;
}

/// Throws TrialFailed unless `proleg drive` has driven the whole gait, and all its modules have taken part in it.
void require_whole_gait(const ChildEnd& end, std::uint32_t ticks) {
  if (end.reason == ChildEnd::Reason::late) {
    throw TrialFailed("'proleg drive' has not ended in time; switch the robot off");
  }
  const nlohmann::json result = nlohmann::json::parse(end.output, nullptr, false);
  std::string message = end.last_message.empty() ? "" : ": " + end.last_message;
  if (end.status != 0) {
    if (message.empty() && result.is_object()) {
      message = ": its result is " + one_line(result.dump());
    }
    constexpr int first_of_signals = 129;  // its last act, the end of the power, is then uncertain
    throw TrialFailed("'proleg drive' has ended with status " + std::to_string(end.status) + message +
                      (end.status >= first_of_signals ? "; switch the robot off" : ""));
  }
  if (!result.is_object() || !result.contains("ticks") || !result.contains("restarts")) {
    throw TrialFailed("'proleg drive' has printed no result" + message);
  }
  if (result["restarts"] != 0) {
    throw TrialFailed("a module has restarted" + message);
  }
  if (result["ticks"] != ticks) {
    throw TrialFailed("the robot was stopped before the end of the gait" + message);
  }
}

/// Lets `proleg drive` read the words of --bus, and the scenario of a simulated robot. Throws BadInput.
void check_bus(const std::string& bus, const sim::Scenario& scenario) {
  const ScratchFolder scratch;
  const fs::path file = optimize::write_scenario(scenario, "A trial of a robot.", scratch.path(), "trial");
  std::vector<std::string> command{program_folder() / "proleg-drive", file, "--bus", bus, "--check"};
  for (const std::string& library : loaded_libraries()) {
    command.insert(command.end(), {"--algorithms", library});
  }
  ChildProgram program(command, ".", ChildProgram::Errors::apart);
  const ChildEnd end = wait_for_end(
      program, time_to_check, [] { return false; }, [](const std::string& /*line*/) {});
  if (end.reason == ChildEnd::Reason::late) {
    throw std::runtime_error("'proleg drive --check' has not ended in " + std::to_string(time_to_check.count()) + " s");
  }
  constexpr std::string_view its_name = "proleg drive: ";
  const std::string problem =
      end.last_message.starts_with(its_name) ? end.last_message.substr(its_name.size()) : end.last_message;
  if (end.status == exit_bad_input) {
    throw BadInput(problem);
  }
  if (end.status != exit_success) {
    throw std::runtime_error("'proleg drive --check' has ended with status " + std::to_string(end.status) +
                             (problem.empty() ? "" : ": " + problem));
  }
}

}  // namespace

RobotTrials::RobotTrials(const TrialOptions& options, const sim::Scenario& scenario,
                         std::span<const optimize::Objective> objectives, const fs::path& folder,
                         std::function<bool()> stop)
    : bus_(options.bus.value()),
      is_simulated_(!simulated_robot(options).empty()),
      folder_(folder / trials_folder),
      stop_(stop),
      score_(options, objectives, print_above_progress, std::move(stop)) {
  sim::require_sensors(scenario, sim::sensors_of_modules, "a module");
  if (!scenario.changes.empty()) {
    throw InputError("--set", 0, "a change during the run", "start values: a trial of a robot has no changes");
  }
  check_bus(bus_, scenario);
}

sim::MeasureValues RobotTrials::make(const sim::Scenario& scenario, const std::string& name) {
  try {
    while (true) {
      if (stop_()) {
        throw optimize::SearchEnded();
      }
      if (const std::optional<sim::MeasureValues> values = score_.measure(drive(scenario, name))) {
        return *values;
      }
    }
  } catch (const TrialFailed& error) {
    throw optimize::SearchFailed(name + " has no score: " + one_line(error.what()));
  }
}

DrivenTrial RobotTrials::drive(const sim::Scenario& scenario, const std::string& name) {
  const fs::path file = optimize::write_scenario(scenario, "A trial of a robot.", folder_, name, "files");
  const fs::path recording = folder_ / (name + ".proleg");
  std::vector<std::string> command{
      program_folder() / "proleg-drive", file, "--bus", bus_, "--record", recording, "--json", "--until-input-ends"};
  if (is_simulated_) {
    command.emplace_back("--fast");
  } else {
    command.insert(command.end(), {"--longest-silence", "0.4"});  // as the host waits for the robot
  }
  for (const std::string& library : loaded_libraries()) {
    command.insert(command.end(), {"--algorithms", library});
  }
  print_above_progress(name + ": the robot will move for " + number_text(scenario.duration_s) + " s");
  // It does not get the Ctrl-C of a terminal: this program passes it on, and a second one is of no effect. If this
  // program is killed, its standard input ends; if it is suspended, no line comes any more.
  const std::unique_ptr<ChildProgram> program = ChildProgram::with_input(command, ".", -1, time_to_stop);
  const auto pass_on = [this](const std::string& line) {
    const bool is_warning = line.find(": warning: ") != std::string::npos;
    if (!is_warning || warnings_.insert(line).second) {
      print_above_progress(line);
    }
  };
  const auto longest = time_around_gait + 2 * std::chrono::duration<double>(scenario.duration_s);
  const auto gives_sign_of_life_until_stop = [&] {
    program->write_line("");
    return stop_();
  };
  const ChildEnd end = wait_for_end(*program, longest, gives_sign_of_life_until_stop, pass_on);
  if (end.reason != ChildEnd::Reason::stopped) {
    require_whole_gait(end, sim::tick_count(scenario));
  }
  if (!end.last_message.empty()) {
    pass_on(end.last_message);
  }
  if (end.reason == ChildEnd::Reason::stopped) {
    throw optimize::SearchEnded();
  }
  return {name, recording, file, scenario};
}

RobotOnBus::RobotOnBus(const optimize::Experiment& experiment, const sim::Scenario& reality, RobotTrials& trials,
                       std::size_t made)
    : experiment_(experiment), reality_(reality), trials_(trials), made_(made) {}

optimize::TrialOutcome RobotOnBus::try_gait(const optimize::Candidate& candidate) {
  sim::Scenario scenario = reality_;
  experiment_.space.apply(candidate, scenario);
  const sim::MeasureValues measures = trials_.make(scenario, "trial_" + std::to_string(made_ + 1));
  ++made_;
  return optimize::outcome_of(experiment_.objectives.front(), measures);
}

RobotWorker::RobotWorker(const optimize::Experiment& experiment, RobotTrials trials)
    : experiment_(experiment), trials_(std::move(trials)) {}

std::optional<optimize::Workers::Done> RobotWorker::wait(std::chrono::milliseconds /*timeout*/) {
  if (!task_) {
    return std::nullopt;
  }
  const optimize::Task& task = task_->task;
  sim::Scenario scenario = experiment_.scenario;
  experiment_.space.apply(task.candidate, scenario);
  std::string name = "evaluation_" + std::to_string(task.number);
  if (experiment_.trials.count > 1) {
    name += "_trial_" + std::to_string(task.trial + 1);
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  optimize::TrialResult result;
  result.measures = trials_.make(scenario, name);
  for (double& value : result.measures.all()) {
    value += 0.0;  // turns -0 into 0: stores do not keep the sign
  }
  result.simulated_s = scenario.duration_s;
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return Done{std::exchange(task_, std::nullopt)->ticket, std::move(result), 0};
}

}  // namespace proleg::tools
