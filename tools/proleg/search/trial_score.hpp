#pragma once

// How a trial on a robot gets its measures: a person types a number, a program prints it, or the recording has them.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {

/// Options of a command whose trials a robot can make.
struct TrialOptions {
  std::optional<std::string> bus;  ///< nothing: the trials are simulated
  std::optional<std::string> score;
  std::optional<std::string> score_command;
  std::optional<std::string> score_timeout;
};

void add_trial_options(CommandLine& command_line, TrialOptions& options);

/// Throws InputError for an option of these trials without --bus.
void require_bus(const TrialOptions& options);

/// "sim:FILE" if the bus of these trials is that of a simulated robot; otherwise empty.
[[nodiscard]] std::string simulated_robot(const TrialOptions& options);

/// The folder of the trials in that of a run: scenario and recording of each.
inline constexpr const char* trials_folder = "trials";

/// A trial has no score. what() is one line.
class TrialFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A trial that the robot has made. It has no power now.
struct DrivenTrial {
  std::string name;
  std::filesystem::path recording;
  std::filesystem::path scenario_file;
  const sim::Scenario& scenario;
};

class TrialScore {
 public:
  /// objectives: their measures are needed. print: shows a line to the user. stop: whether the user stops; called
  /// often. Throws InputError for bad options, and if the trials cannot have all measures: those that the recording of
  /// a robot does not have (sim/record/module_measures.hpp), except one that a person or a program measures.
  TrialScore(const TrialOptions& options, std::span<const optimize::Objective> objectives,
             std::function<void(const std::string& line)> print, std::function<bool()> stop);

  /// The measures of a trial; nothing if the user wants it to be made again. Throws TrialFailed; SearchEnded if the
  /// user ends the trials.
  [[nodiscard]] std::optional<sim::MeasureValues> measure(const DrivenTrial& trial);

 private:
  enum class Source : std::uint8_t { person, program, recording };

  [[nodiscard]] std::optional<double> ask(const DrivenTrial& trial);
  [[nodiscard]] double run_program(const DrivenTrial& trial) const;
  /// The next line that the user types. Throws SearchEnded, also if the user stops.
  [[nodiscard]] std::string next_line();

  Source source_ = Source::person;
  std::string program_;
  std::chrono::duration<double> timeout_{60.0};
  sim::Measure measured_ = sim::Measure::distance;  ///< by the person or the program
  std::vector<sim::Measure> needed_;
  std::function<void(const std::string& line)> print_;
  std::function<bool()> stop_;
  InputLines input_lines_;
};

}  // namespace proleg::tools
