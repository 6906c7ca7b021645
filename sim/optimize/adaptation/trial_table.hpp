#pragma once

// The trials of an adaptation as a table, from which it continues.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"

namespace proleg::optimize {

/// A trial that was made.
struct MadeTrial {
  std::size_t gait = 0;   ///< position in Atlas::gaits
  double expected = 0.0;  ///< score, before the trial
  double deviation = 0.0;
  double measured = 0.0;  ///< score
  std::string failure;    ///< why it has no score of its own; empty: it has one
};

/// Where trials come from, and what they have shown. Texts without line ends.
struct TrialComments {
  std::string inputs;  ///< tells adaptations apart, such as a fingerprint
  std::string atlas;   ///< folder of the atlas, as a path from the folder of the table
  std::string robot;   ///< what makes the trials, for people
  /// What is probably wrong with the robot, for people; empty: nothing was suspected.
  std::string diagnosis = {};
};

/// The comments; a head; and a line for each trial: its number from 1, place and middle of its cell,
/// the gait's values, expected score and its standard deviation, measured score, failure. Columns are separated by
/// tabs.
[[nodiscard]] std::string trial_table(const Atlas& atlas, const TrialComments& comments,
                                      const std::vector<MadeTrial>& trials);

/// Reads what trial_table() wrote. name: of the file, for messages. Throws InputError if it is damaged or has other
/// inputs.
[[nodiscard]] std::vector<MadeTrial> read_trial_table(const Atlas& atlas, const std::string& inputs,
                                                      const std::string& name, std::string_view text);

/// A trial as its line says it, without the atlas.
struct NotedTrial {
  std::string place;           ///< of its cell, as GaitMap::place_text()
  std::vector<double> values;  ///< of the gait: one for each dimension of the search
  double expected = 0.0;
  double deviation = 0.0;
  double measured = 0.0;
  std::string failure;
};
struct TrialNotes {
  TrialComments comments;
  std::vector<NotedTrial> trials;
};
/// What a table says, also if its atlas has changed since: of its lines those up to the first one that is damaged.
/// axes: number of axes of the atlas. Nothing if it is no table of trials, or does not say where its atlas is.
[[nodiscard]] std::optional<TrialNotes> look_at_trials(std::string_view text, std::size_t axes);

}  // namespace proleg::optimize
