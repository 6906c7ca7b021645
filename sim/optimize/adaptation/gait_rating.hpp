#pragma once

// What the gaits of an atlas do in simulation before the first trial: in trials of another length, and on the robot
// with damages that it may have.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/damage_scores.hpp"

namespace proleg::optimize {

/// The share of a work that is done, 0 to 1.
using ShareDone = std::function<void(double share)>;

/// Rates the gaits for runs of another length, in the engine of the search, and drops those without a score; nothing is
/// done if the runs have that length already. stop: called in each tick. Throws SearchEnded if it returned true;
/// StoreError if no gait is left, or if a robot has filled the map.
void rate_for_length(Atlas& atlas, double seconds, const ShareDone& progress, const std::function<bool()>& stop);

/// What the gaits do with each of some damages, in the engine and for the length of the atlas's runs. damages: words of
/// sim::apply_damage(). Computed in as many threads as the machine has. progress: called in one thread at a time. stop:
/// called in each tick, in several threads. Throws SearchEnded if it returned true; InputError as sim::apply_damage().
[[nodiscard]] DamageScores rate_with_damages(const Atlas& atlas, std::span<const std::string> damages,
                                             const ShareDone& progress, const std::function<bool()>& stop);

/// What may be true of the robot: first that it is as the atlas has it; then that it has another damage than those
/// here; then that it has one of them. scores: of these damages, of rate_with_damages().
[[nodiscard]] std::vector<Hypothesis> hypotheses_of(const Atlas& atlas, std::span<const std::string> damages,
                                                    const DamageScores& scores);

}  // namespace proleg::optimize
