#include "tools/proleg/search/trial_score.hpp"

#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/record/module_measures.hpp"
#include "tools/proleg/common/child_program.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/search/watched_child.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

bool is_in_recordings(sim::Measure measure) { return std::ranges::count(sim::measures_of_modules(), measure) > 0; }

std::string names_of(std::span<const sim::Measure> measures) {
  std::vector<std::string> names;
  for (const sim::Measure measure : measures) {
    names.emplace_back(sim::declaration_of(measure).name);
  }
  return listed(names);
}

/// The measures of the objectives that no recording of a robot has.
std::vector<sim::Measure> measures_to_take(std::span<const optimize::Objective> objectives) {
  std::vector<sim::Measure> measures;
  for (const optimize::Objective& objective : objectives) {
    for (const optimize::Term& term : objective.terms) {
      if (!is_in_recordings(term.measure) && std::ranges::count(measures, term.measure) == 0) {
        measures.push_back(term.measure);
      }
    }
  }
  return measures;
}

void require_program(const std::string& program) {
  const bool is_path = program.find('/') != std::string::npos;
  if (program.empty() ||
      (is_path ? access(program.c_str(), X_OK) != 0 || fs::is_directory(program) : !is_installed(program))) {
    throw InputError("--score-command", 0, in_quotes(program),
                     is_path ? "a program: a file that may be executed" : "a program in a folder of PATH, or its path");
  }
}

/// "distance in m"
std::string with_unit(sim::Measure measure) {
  const sim::MeasureDeclaration& declaration = sim::declaration_of(measure);
  return std::string(declaration.name) + (declaration.unit.empty() ? "" : " in " + std::string(declaration.unit));
}

/// A larger number is no measure of a robot; sums with it could overflow.
constexpr double largest_number = 1e9;

bool is_possible(double number, sim::Measure measure) {
  return std::abs(number) <= largest_number && (number >= 0.0 || sim::declaration_of(measure).may_be_negative);
}

/// So many are no person's: another program writes into standard input.
constexpr int most_wrong_answers = 100;

/// "number from 0 to 1e9 (distance in m)"
std::string expected_number(sim::Measure measure) {
  return std::string("number from ") + (sim::declaration_of(measure).may_be_negative ? "-1e9" : "0") + " to 1e9 (" +
         with_unit(measure) + ")";
}

}  // namespace

void add_trial_options(CommandLine& command_line, TrialOptions& options) {
  command_line
      .add_option(
          "--bus", options.bus,
          "a robot of modules on this bus makes the trials: 'proleg drive --help' says what BUS can be. Between "
          "two trials its servos have no power.")
      .value_name("BUS");
  command_line
      .add_option("--score", options.score,
                  "with --bus, how a trial gets its score: ask (a person types what was measured; the default); "
                  "recording (from what the modules have measured)")
      .value_name("HOW");
  command_line
      .add_option("--score-command", options.score_command,
                  "with --bus, a program that measures: it gets the paths of a trial's recording and scenario, and "
                  "prints one number")
      .value_name("PROGRAM")
      .excludes("--score");
  command_line
      .add_option("--score-timeout", options.score_timeout, "longest time of that program in seconds; default: 60")
      .value_name("SECONDS");
}

void require_bus(const TrialOptions& options) {
  for (const auto& [option, is_given] : {std::pair("--score", options.score.has_value()),
                                         std::pair("--score-command", options.score_command.has_value()),
                                         std::pair("--score-timeout", options.score_timeout.has_value())}) {
    if (is_given && !options.bus) {
      throw InputError(option, 0, "an option for the trials of a robot", "--bus BUS beside it");
    }
  }
}

std::string simulated_robot(const TrialOptions& options) {
  constexpr std::string_view kind = "sim:";
  const std::string bus = options.bus.value_or("");
  return lower_case(bus.substr(0, kind.size())) == kind ? std::string(kind) + bus.substr(kind.size()) : std::string();
}

TrialScore::TrialScore(const TrialOptions& options, std::span<const optimize::Objective> objectives,
                       std::function<void(const std::string& line)> print, std::function<bool()> stop)
    : print_(std::move(print)), stop_(std::move(stop)) {
  if (options.score_command) {
    require_program(*options.score_command);
    source_ = Source::program;
    program_ = *options.score_command;
  } else if (options.score == "recording") {
    source_ = Source::recording;
  } else if (options.score && options.score != "ask") {
    throw InputError("--score", 0, in_quotes(*options.score), "ask or recording");
  }
  if (options.score_timeout) {
    const std::optional<double> seconds = parse_number(*options.score_timeout);
    if (!seconds || *seconds < 0.1 || *seconds > 86'400.0) {
      throw InputError("--score-timeout", 0, in_quotes(*options.score_timeout), "0.1 to 86400 seconds");
    }
    if (source_ != Source::program) {
      throw InputError("--score-timeout", 0, "no program", "--score-command PROGRAM beside it");
    }
    timeout_ = std::chrono::duration<double>(*seconds);
  }
  const std::vector<sim::Measure> to_take = measures_to_take(objectives);
  if (source_ == Source::recording && !to_take.empty()) {
    throw InputError("--score", 0, "recording, and " + names_of(to_take) + " to be measured",
                     "--score ask or --score-command, or an objective of what the recording of a robot has: " +
                         names_of(sim::measures_of_modules()));
  }
  if (to_take.size() > 1) {
    throw InputError("--bus", 0, names_of(to_take) + " to be measured in a trial",
                     "at most one measure that the recording of a robot does not have; it has " +
                         names_of(sim::measures_of_modules()));
  }
  for (const optimize::Objective& objective : objectives) {
    std::ranges::transform(objective.terms, std::back_inserter(needed_), &optimize::Term::measure);
  }
  measured_ = to_take.empty() ? objectives.front().terms.front().measure : to_take.front();
}

std::optional<sim::MeasureValues> TrialScore::measure(const DrivenTrial& trial) {
  sim::MeasureValues values;
  try {
    values = sim::measure_modules(sim::Recording(trial.recording), trial.scenario);
  } catch (const std::exception& error) {
    throw TrialFailed(error.what());
  }
  for (const sim::Measure measure : needed_) {
    const bool is_of_modules = source_ == Source::recording || measure != measured_;
    if (is_of_modules && sim::is_sensed_by_modules(measure) && std::isnan(values[measure])) {
      throw TrialFailed("the modules of this robot have not measured what " +
                        std::string(sim::declaration_of(measure).name) + " needs");
    }
  }
  if (source_ != Source::recording) {
    const std::optional<double> number = source_ == Source::person ? ask(trial) : std::optional(run_program(trial));
    if (!number) {
      return std::nullopt;
    }
    values[measured_] = *number;
  }
  return values;
}

std::string TrialScore::next_line() {
  constexpr std::chrono::milliseconds pause{50};
  while (!stop_()) {  // asked before each line: there may be lines without an end
    if (std::optional<std::string> line = input_lines_.next()) {
      return *std::move(line);
    }
    if (input_lines_.has_ended()) {
      print_("standard input has ended: no further trial");
      throw optimize::SearchEnded();
    }
    std::this_thread::sleep_for(pause);
  }
  throw optimize::SearchEnded();
}

std::optional<double> TrialScore::ask(const DrivenTrial& trial) {
  if (isatty(STDIN_FILENO) == 1) {
    tcflush(STDIN_FILENO, TCIFLUSH);  // a line that was typed before the question must not let the robot move
  }
  print_(trial.name + ": the servos have no power. Put the robot back, then type its " + with_unit(measured_) +
         ": the next trial begins at once. Or: again (make this trial once more), stop (end the trials)");
  for (int wrong = 0; wrong < most_wrong_answers; ++wrong) {
    const std::string whole_line = next_line();
    const bool is_too_long = whole_line.size() > InputLines::longest_line;
    const std::string line(is_too_long ? std::string_view() : trimmed(whole_line));
    if (line == "again") {
      return std::nullopt;
    }
    if (line == "stop") {
      throw optimize::SearchEnded();
    }
    if (const std::optional<double> number = parse_number(line); number && is_possible(*number, measured_)) {
      return number;
    }
    print_("found " +
           (is_too_long ? "a line of more than " + std::to_string(InputLines::longest_line) + " characters"
                        : in_quotes(line)) +
           ", expected a " + expected_number(measured_) + ", again or stop");
  }
  print_(std::to_string(most_wrong_answers) + " wrong answers: no further trial");
  throw optimize::SearchEnded();
}

double TrialScore::run_program(const DrivenTrial& trial) const {
  const std::vector<std::string> command{program_, fs::absolute(trial.recording).string(),
                                         fs::absolute(trial.scenario_file).string()};
  const ChildEnd end = [&] {
    try {
      ChildProgram program(command, ".", ChildProgram::Errors::apart);
      return wait_for_end(program, timeout_, stop_, print_);
    } catch (const std::runtime_error& error) {  // it was there when the trials began
      throw TrialFailed(error.what());
    }
  }();
  const std::string text(trimmed(end.output));
  const std::optional<double> number = parse_number(text);
  std::string found;
  if (end.reason == ChildEnd::Reason::stopped) {
    throw optimize::SearchEnded();
  }
  if (end.reason == ChildEnd::Reason::late) {
    found = "no end in " + proleg::number_text(timeout_.count()) + " s";
  } else if (end.status != 0) {
    found = "exit status " + std::to_string(end.status) + (end.last_message.empty() ? "" : ": " + end.last_message);
  } else if (!number || !is_possible(*number, measured_)) {
    found = text.empty() ? "no output" : in_quotes(one_line(text));
  } else {
    if (!end.last_message.empty()) {
      print_(end.last_message);
    }
    return *number;
  }
  throw TrialFailed(program_ + " of " + trial.recording.string() + ": found " + found +
                    ", expected exit status 0 and, on standard output, one " + expected_number(measured_));
}

}  // namespace proleg::tools
