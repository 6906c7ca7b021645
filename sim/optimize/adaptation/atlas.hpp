#pragma once

// The map of gaits that a search has left in its folder, as the prior of an adaptation.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A filled cell of the map, with its gait.
struct AtlasGait {
  std::size_t cell = 0;  ///< number of the cell (GaitMap)
  Candidate candidate;
  double score = 0.0;  ///< of the objective
};

struct Atlas {
  Experiment experiment;         ///< has axes
  std::vector<AtlasGait> gaits;  ///< at least one

  /// The cells for an adaptation, in the order of the gaits; the higher a value, the better. The point of a gait is the
  /// middle of its cell, and its values, each from 0 at the first to 1 at the last of its dimension: measures of the
  /// whole robot do not tell which joints a gait uses, and so which gaits a damage of one joint concerns.
  [[nodiscard]] std::vector<AdaptationCell> cells() const;
  /// SHA-256 of the search and of the gaits that it has found: 64 hexadecimal digits.
  [[nodiscard]] std::string fingerprint() const;
};

/// Reads the store of a search with MAP-Elites. path: the store, or the folder that has one (store.sqlite). Throws
/// StoreError, also if the search has no map or no gait, or has another fingerprint than its files; InputError as
/// read_experiment_of().
[[nodiscard]] Atlas read_atlas(const std::filesystem::path& path);

/// Rates the gaits for runs of another length, in the engine of the search, and drops those without a score; nothing is
/// done if the runs have that length already. progress: called with the share that is done. stop: called in each tick.
/// Throws SearchEnded if it returned true; StoreError if no gait is left, or if a robot has filled the map.
void rate_for_length(Atlas& atlas, double seconds, const std::function<void(double share)>& progress,
                     const std::function<bool()>& stop);

/// Throws InputError, with the scenario's file, if the gaits do not mean the same on the scenario's robot: its joints
/// have other names or axes, or its actuation has other modules, or other values of what the search does not choose.
/// World, masses, limits and servos may differ.
void require_same_robot(const Atlas& atlas, const sim::Scenario& scenario);

}  // namespace proleg::optimize
