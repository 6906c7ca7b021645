#pragma once

// A run of `proleg adapt`: its trials, the files of its folder, and what it prints.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/adaptation/trial_table.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/search/made_trials.hpp"
#include "tools/proleg/search/robot_trials.hpp"

namespace proleg::tools {

/// What a run says of itself beside its trials.
struct AdaptationLabels {
  optimize::TrialComments comments;  ///< of the table, without the diagnosis
  std::string maker;                 ///< of the trials: an engine or the robot
  Json head;                         ///< the first members of what --json prints
  bool prints_json = false;
};

class AdaptationRun {
 public:
  /// Files and folders; the first one is the table, from which a run continues.
  static constexpr std::array<std::string_view, 6> files{
      "trials.tsv", "trials.svg", "adapted.simulation.xml", "adapted.actuation.xml", "adapted.files", trials_folder};

  /// intact: the scenario without the damages of the command line. Both must outlive this. made: knows the trials of an
  /// earlier run.
  AdaptationRun(AdaptationLabels labels, const optimize::Atlas& atlas, const sim::Scenario& intact,
                std::filesystem::path folder, MadeTrials made);

  /// Makes trials until they end, the user stops them, or one fails, and writes the table after each. Throws only if no
  /// trial was made.
  void make_trials(optimize::TrialRobot& robot);
  /// Writes picture and scenario, prints the result, and returns the exit status.
  int finish();
  /// The user has stopped this command while it simulated the gaits of the atlas: it knows what was tried earlier, and
  /// nothing of what the gaits promise now. Writes no file. Returns the exit status.
  int end_before_trials();

 private:
  void write_table();
  void write_adapted() const;
  void print() const;
  void print_how_to_continue() const;
  [[nodiscard]] std::string count_text() const;
  [[nodiscard]] std::string ending() const;
  [[nodiscard]] Json json() const;
  [[nodiscard]] bool is_cut_short() const { return is_stopped_ || failure_; }

  AdaptationLabels labels_;
  const optimize::Atlas& atlas_;
  const sim::Scenario& intact_;
  std::filesystem::path folder_;
  MadeTrials made_;
  std::size_t resumed_;  ///< number of trials of an earlier run
  bool is_stopped_ = false;
  bool has_expectations_ = true;
  std::optional<std::string> failure_;  ///< why no further trial could be made, or a file not be written
};

}  // namespace proleg::tools
