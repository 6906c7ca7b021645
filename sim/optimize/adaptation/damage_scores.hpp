#pragma once

// What the gaits of an atlas do with damages, kept as text: to simulate them takes longer than a trial, and each
// adaptation with the atlas needs them.

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::optimize {

/// By damage, as a word of sim::apply_damage(): the score of each gait, in the order of the atlas.
using DamageScores = std::map<std::string, std::vector<double>>;

/// inputs: what decides the scores, such as a fingerprint, without line ends.
[[nodiscard]] std::string text_of(const DamageScores& scores, const std::string& inputs);

/// Reads what text_of() wrote. Nothing if it has other inputs or is damaged; a score for each of `gaits` otherwise.
[[nodiscard]] DamageScores read_damage_scores(std::string_view text, const std::string& inputs, std::size_t gaits);

}  // namespace proleg::optimize
