#pragma once

// The trials of an adaptation as a table, from which it continues.

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

/// A comment with the inputs; a head; and a line for each trial: its number from 1, place and middle of its cell,
/// the gait's values, expected score and its standard deviation, measured score, failure. Columns are separated by
/// tabs. inputs: a text without line ends that tells adaptations apart, such as a fingerprint.
[[nodiscard]] std::string trial_table(const Atlas& atlas, const std::string& inputs,
                                      const std::vector<MadeTrial>& trials);

/// Reads what trial_table() wrote. name: of the file, for messages. Throws InputError if it is damaged or has other
/// inputs.
[[nodiscard]] std::vector<MadeTrial> read_trial_table(const Atlas& atlas, const std::string& inputs,
                                                      const std::string& name, std::string_view text);

}  // namespace proleg::optimize
