#pragma once

// The experiments of the thesis that `proleg experiment` repeats, as data: their methods and files, their tables and
// figures, and what the thesis prints of them beside its tables.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// A method of an experiment: its name on the command line, its file, and the names of its table and figures.
struct ThesisMethod {
  std::string_view name;
  std::string_view file;
  std::string_view table;
  std::string_view runs_figure;    ///< every repetition
  std::string_view spread_figure;  ///< lowest, mean and highest
};

/// A scenario without a search, whose distance stands beside those of the searches.
struct ReferenceScenario {
  std::string_view name;        ///< "uniform amplitudes of 40 deg"
  std::string_view short_name;  ///< in figures: "uniform"
  std::string_view file;        ///< empty: the scenario of the searches, without changes
  double thesis_m;              ///< distance that the thesis reports; 0: none
};

/// A row of a table of the thesis.
struct ThesisRow {
  std::string name;
  std::size_t dimension;  ///< of the search space
};

struct ThesisExperiment {
  std::string_view name;         ///< on the command line
  std::string_view title;        ///< of the figure that compares the methods
  std::string_view about;        ///< for --help
  std::string_view repetitions;  ///< of each method, unless the command says how many
  std::string_view engine;       ///< of the searches, unless the command names one; empty: that of the files
  std::span<const ThesisMethod> methods;
  /// The first one is what gains are relative to.
  std::span<const ReferenceScenario> references;
  /// The file of the reference without an obstacle. The best gaits are checked there and in perturbed worlds. Empty:
  /// they are not.
  std::string_view level_ground;
  std::string_view comparison_figure;
  std::string_view overtaking;   ///< evaluations after which the thesis's great deluge is above its genetic algorithm
  std::string_view shown_value;  ///< heading of the value of the best that the summary shows
  std::size_t shown_row;         ///< its row
  std::string_view shown_unit;
  /// The rows of the experiment's tables, in the thesis's order.
  std::vector<ThesisRow> (*rows)(const SearchSpace& space);
};

/// Section 6.1: the amplitudes of a travelling wave.
[[nodiscard]] const ThesisExperiment& travelling_wave_experiment();
/// Section 6.2: the constants of the adaptive algorithm.
[[nodiscard]] const ThesisExperiment& adaptive_touch_experiment();

[[nodiscard]] std::span<const ThesisExperiment* const> thesis_experiments();

}  // namespace proleg::optimize
