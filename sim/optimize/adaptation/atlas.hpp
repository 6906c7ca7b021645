#pragma once

// The map of gaits that a search has left in its folder, as the prior of an adaptation.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

struct AtlasGait {
  std::size_t cell = 0;  ///< number of its cell (GaitMap)
  Candidate candidate;
  double score = 0.0;  ///< of the objective
};

struct Atlas {
  Experiment experiment;         ///< has axes
  std::vector<AtlasGait> gaits;  ///< at least one; first the best of each filled cell, in the order of the cells
  std::vector<std::string> remarks = {};  ///< axis_remarks() of the search

  /// The points of the gaits for an adaptation. The point of a gait is the middle of its cell, and its values, each
  /// from 0 at the first to 1 at the last of its dimension: measures of the whole robot do not tell which joints a gait
  /// uses, and so which gaits a damage of one joint concerns.
  [[nodiscard]] std::vector<std::vector<double>> points() const;
  /// SHA-256 of the search and of the gaits that it has found: 64 hexadecimal digits.
  [[nodiscard]] std::string fingerprint() const;
};

/// Reads the store of a search with MAP-Elites: the best gait of each filled cell, and then up to `most_others` gaits
/// that the search has tried, each as unlike all before it as there is: the best gaits of an intact robot resemble each
/// other, and some damages need another kind. path: the store, or the folder that has one (store.sqlite). Throws
/// StoreError, also if the search has no map or no gait, or has another fingerprint than its files; InputError as
/// read_experiment_of().
[[nodiscard]] Atlas read_atlas(const std::filesystem::path& path, std::size_t most_others = 100);

/// Throws InputError, with the scenario's file, if the gaits do not mean the same on the scenario's robot: its joints
/// have other names or axes, or its actuation has other modules, or other values of what the search does not choose.
/// World, masses, limits and servos may differ.
void require_same_robot(const Atlas& atlas, const sim::Scenario& scenario);

}  // namespace proleg::optimize
