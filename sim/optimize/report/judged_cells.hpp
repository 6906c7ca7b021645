#pragma once

// A sample of the cells of a map of gaits, simulated again in the judging engine: how far a map that another engine
// filled holds.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Draws filled cells of the map and returns their candidates, by cell: the filled cells in their order are divided
/// into `count` equal parts, and one is drawn from each, with the experiment's seed. Each filled cell is drawn with the
/// same probability. All of them if the map has no more. evaluations: of one run, by number.
[[nodiscard]] std::vector<Evaluation> choose_cells(const Experiment& experiment,
                                                   std::span<const Evaluation> evaluations, std::size_t count);

/// Spearman's rank correlation; equal values share the mean of their ranks. NaN if all values of a side are equal, or
/// for fewer than two.
[[nodiscard]] double rank_correlation(std::span<const double> left, std::span<const double> right);

/// How an objective or the measure of an axis agrees between the map and the judging engine, over cells that have it in
/// both.
struct EngineAgreement {
  std::string name;
  double mean_in_map = 0.0;
  double mean_judged = 0.0;
  double mean_difference = 0.0;   ///< mean of the absolute differences
  double rank_correlation = 0.0;  ///< NaN if it is not defined
};

struct MapAgreement {
  std::size_t cells = 0;                    ///< the sample
  std::size_t with_place = 0;               ///< of them with a score and a cell in the judging engine, too
  std::size_t in_the_cell = 0;              ///< of them in the same cell there
  std::size_t near_it = 0;                  ///< in the same cell or in one that touches it
  std::vector<EngineAgreement> objectives;  ///< the objective, then each axis

  /// Mean score in the judging engine as a share of that of the map; nothing if the map's is 0.
  [[nodiscard]] std::optional<double> score_ratio() const;
};

/// sample: the candidates that choose_cells() gave, with their fresh runs.
[[nodiscard]] MapAgreement agreement_of(const Experiment& experiment, std::span<const Confirmation> sample);

/// Table with tabs and a header line: each cell of the sample, in the order that is given. Columns: its number on each
/// axis, from 1 ("cell:height"); evaluation; each dimension; objective and measures of the axes in the search and in
/// the judging engine ("distance (m) (reduced)"); its number on each axis there ("judged:height"), empty for a run that
/// is in no cell.
[[nodiscard]] std::string judged_table(const Experiment& experiment, std::span<const Confirmation> sample);

}  // namespace proleg::optimize
