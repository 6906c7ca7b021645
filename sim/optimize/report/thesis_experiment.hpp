#pragma once

// Tables and figures of an experiment of the thesis (thesis_data.hpp), made from our runs, with the thesis's
// numbers beside them. The score is the distance in metres, and more is better. Tables have the judged distances, if
// these exist; the figures show the courses of the searches.

#include <span>
#include <string>
#include <vector>

#include "sim/optimize/report/method_runs.hpp"
#include "sim/optimize/report/thesis_data.hpp"

namespace proleg::optimize {

/// The distance of a reference scenario in our simulation.
struct Reference {
  const ReferenceScenario* scenario;
  double searched_m;  ///< distance in the engine of the searches
  double judged_m;    ///< distance in the judging engine
};

/// Table with tabs: the values and distances of the ten best repetitions, best first, and below them those of the
/// thesis, if it has a table for the method. Columns: source, value, 1 to 10.
[[nodiscard]] std::string experiment_table(const ThesisExperiment& experiment, const MethodRuns& method);

/// Draws figures 6.3, 6.5, 6.10 and 6.12 as SVG: the best so far of each repetition.
[[nodiscard]] std::string draw_every_run(const ThesisExperiment& experiment, const MethodRuns& method,
                                         std::span<const Reference> references);
/// Draws figures 6.4, 6.6, 6.11 and 6.13 as SVG: lowest, mean and highest best so far over the repetitions.
[[nodiscard]] std::string draw_run_spread(const ThesisExperiment& experiment, const MethodRuns& method,
                                          std::span<const Reference> references);
/// Draws figures 7.1 and 7.2 as SVG: (a) each repetition of each method, (b) the means.
[[nodiscard]] std::string draw_method_comparison(const ThesisExperiment& experiment,
                                                 std::span<const MethodRuns> methods,
                                                 std::span<const Reference> references);

/// A summary for people, a few dozen lines of at most 120 characters: the references; each method's repetitions,
/// evaluations, best, mean and gain over the first reference; whether the methods differ; whether great deluge
/// overtakes the genetic algorithm; and the numbers of evaluations after which other methods reach great deluge's mean.
[[nodiscard]] std::string experiment_summary(const ThesisExperiment& experiment, std::span<const MethodRuns> methods,
                                             std::span<const Reference> references);

/// The difference between the best distances of two methods' repetitions.
struct MethodDifference {
  std::string one;
  std::string other;
  double share_above = 0.0;  ///< share of the pairs of repetitions in which `one` goes farther
  double p_value = 1.0;      ///< p-value of the rank-sum test, corrected for the number of pairs of methods
};

/// The differences of all pairs of methods that have runs, in their order.
[[nodiscard]] std::vector<MethodDifference> method_differences(std::span<const MethodRuns> methods);

}  // namespace proleg::optimize
