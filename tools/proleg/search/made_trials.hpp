#pragma once

// The trials that an adaptation has made, and what it has learned from them: for people, as JSON and as a picture.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/trial_table.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

class MadeTrials {
 public:
  /// atlas: must outlive this. hypotheses: of optimize::hypotheses_of(); damages: those that it was given.
  MadeTrials(const optimize::Atlas& atlas, std::vector<optimize::Hypothesis> hypotheses,
             const std::vector<std::string>& damages, const optimize::AdaptationSettings& settings);

  /// Learns from a trial.
  void add(const optimize::MadeTrial& trial);
  /// The gait to try next, its expected score and the deviation; nothing when the trials have ended.
  [[nodiscard]] std::optional<optimize::MadeTrial> next() const;

  [[nodiscard]] const std::vector<optimize::MadeTrial>& all() const { return trials_; }
  /// The best one of those with a score of their own; null if there is none.
  [[nodiscard]] const optimize::MadeTrial* best() const;
  [[nodiscard]] const optimize::Candidate& gait_of(const optimize::MadeTrial& trial) const {
    return atlas_.gaits[trial.gait].candidate;
  }
  /// "good enough", "trials used up"; empty while trials go on.
  [[nodiscard]] std::string ending() const { return std::string(optimize::text_of(adaptation_.ending())); }

  /// The last trial in one line: its cell, the expected and the measured score.
  [[nodiscard]] std::string line_of_last() const;
  /// "trial 3, 1.9 m (distance); the best that is expected of any cell: 2 m"
  [[nodiscard]] std::string text_of_best() const;
  /// What is likely wrong with the robot after the trials, the most likely first: "powerless:J4 92 %, none 6 %". Empty
  /// if no damage was suspected.
  [[nodiscard]] std::string text_of_diagnosis() const;
  /// Adds the trials and the best of them to the result of a run.
  void add_trials_to(Json& object) const;
  /// Adds what is expected of the gaits, and the probabilities of the damages.
  void add_expectations_to(Json& object) const;
  /// The map with what is expected of each cell now, as SVG.
  [[nodiscard]] std::string picture() const;

 private:
  [[nodiscard]] double value_of(double score) const { return -objective_.cost(score); }
  [[nodiscard]] double score_of(double value) const { return objective_.cost(-value); }
  [[nodiscard]] std::size_t number_of(const optimize::MadeTrial& trial) const;
  [[nodiscard]] double best_expected() const;
  [[nodiscard]] Json object_of(const optimize::MadeTrial& trial) const;
  /// The numbers of the hypotheses, the most likely first.
  [[nodiscard]] std::vector<std::size_t> likely_hypotheses() const;

  const optimize::Atlas& atlas_;
  const optimize::GaitMap map_;  ///< for the places of its cells
  const optimize::Objective& objective_;
  std::vector<std::string> names_;  ///< of the hypotheses
  optimize::Adaptation adaptation_;
  std::vector<optimize::MadeTrial> trials_;
};

}  // namespace proleg::tools
