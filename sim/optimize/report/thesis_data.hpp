#pragma once

// The experiments of the thesis that `proleg experiment` repeats, as data: their methods and files, their tables and
// figures, other numbers that the thesis prints, and its published results. These are in thesis_tables.tsv, which the
// build embeds, so an installed program needs no file.

#include <array>
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
  std::string_view runs_figure;    ///< name of the figure with each repetition
  std::string_view spread_figure;  ///< name of the figure with lowest, mean and highest
};

/// A scenario without a search, whose distance stands beside those of the searches.
struct ReferenceScenario {
  std::string_view name;        ///< "uniform amplitudes of 40 deg"
  std::string_view short_name;  ///< name in figures: "uniform"
  std::string_view file;        ///< file of the scenario; empty: that of the searches, without changes
  double thesis_m;              ///< distance in the thesis; 0: it reports none
};

/// A row of a table of the thesis.
struct ThesisRow {
  std::string name;
  std::size_t dimension;  ///< dimension of the search space
};

struct ThesisExperiment {
  std::string_view name;         ///< name on the command line
  std::string_view title;        ///< title of the figure that compares the methods
  std::string_view about;        ///< text for --help
  std::string_view repetitions;  ///< repetitions of each method, unless the command gives their number
  std::string_view engine;       ///< engine of the searches, unless the command names one; empty: that of the files
  std::span<const ThesisMethod> methods;
  /// The reference scenarios; gains are relative to the first one.
  std::span<const ReferenceScenario> references;
  /// The file of the reference without an obstacle. The best gaits are checked there and in perturbed worlds. If it is
  /// empty, they are not checked.
  std::string_view level_ground;
  std::string_view comparison_figure;
  std::string_view overtaking;   ///< evaluations after which the thesis's great deluge is above its genetic algorithm
  std::string_view shown_value;  ///< heading of the value of the best that the summary shows
  std::size_t shown_row;         ///< row of shown_value
  std::string_view shown_unit;
  /// The rows of the experiment's tables, in the thesis's order.
  std::vector<ThesisRow> (*rows)(const SearchSpace& space);
};

/// The experiment of section 6.1: the amplitudes of a travelling wave.
[[nodiscard]] const ThesisExperiment& travelling_wave_experiment();
/// The experiment of section 6.2: the constants of the adaptive algorithm.
[[nodiscard]] const ThesisExperiment& adaptive_touch_experiment();

[[nodiscard]] std::span<const ThesisExperiment* const> thesis_experiments();

inline constexpr std::size_t thesis_columns = 10;
inline constexpr std::string_view thesis_distance_row = "Displacement [m]";

/// The published results of a method: its ten best runs, best first.
struct ThesisResult {
  struct Row {
    std::string name;
    std::array<double, thesis_columns> values;
  };

  std::string experiment;  ///< name of the experiment in `proleg experiment`
  std::string method;      ///< name of the method
  std::string table;       ///< "table 6.2"
  unsigned runs = 0;       ///< number of runs in the thesis
  std::vector<Row> rows;   ///< the values of the parameters, as the thesis lists them
  std::array<double, thesis_columns> displacements_m{};
};

/// The results in tables 6.2 and 6.7 (great deluge), 6.4 and 6.9 (genetic algorithm).
[[nodiscard]] std::span<const ThesisResult> thesis_results();
/// Finds the result of a method; null if the thesis has no table for it.
[[nodiscard]] const ThesisResult* find_thesis_result(std::string_view experiment, std::string_view method);

/// Reads a text in the format of thesis_tables.tsv. Throws InputError, which names `file` and the line.
[[nodiscard]] std::vector<ThesisResult> read_thesis_tables(std::string_view text, const std::string& file);

/// The text of thesis_tables.tsv when this program was built.
[[nodiscard]] std::string_view thesis_tables_text();

}  // namespace proleg::optimize
