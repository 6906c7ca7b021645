#pragma once

// Repeated searches: their course, which is the best score so far after each evaluation, and whether the results of two
// methods differ by more than chance. More is better.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// All repetitions of the experiment with one method.
struct MethodRuns {
  std::string method;                         ///< result of method_name()
  SearchSpace space;                          ///< search space of the candidates
  std::vector<std::vector<Evaluation>> runs;  ///< the evaluations of each repetition, in order
  /// The best of each repetition of judged searches, with the score that the judging engine gave it. Otherwise empty.
  std::vector<Evaluation> judged{};
  std::string engine{};  ///< the engine of the evaluations, if it is not the judging one
};

/// Best score so far after each evaluation of a run.
[[nodiscard]] std::vector<double> best_so_far(std::span<const Evaluation> run);

/// Best scores over all repetitions, after each evaluation of the longest one. A repetition that has ended keeps its
/// last best.
struct BestCurves {
  std::vector<double> min;
  std::vector<double> mean;
  std::vector<double> max;
};
[[nodiscard]] BestCurves best_curves(const MethodRuns& method);

/// Number of the last evaluation, from 1, at which the mean of `follower` is not above that of `leader`. 0: `follower`
/// is above from the start. Nothing: it does not end above.
[[nodiscard]] std::optional<std::size_t> overtaking(const BestCurves& follower, const BestCurves& leader);

/// Number of evaluations, from 1, after which the mean is at least `score`.
[[nodiscard]] std::optional<std::size_t> evaluations_to_reach(const BestCurves& curves, double score);

// Best distances are not normally distributed: searches end on one summit or the other. A test of ranks needs no
// distribution.

/// Share of the pairs (a, b) in which a is greater; equal ones count half. 0 to 1; NaN if a group is empty.
[[nodiscard]] double share_above(std::span<const double> a, std::span<const double> b);

/// Two-sided p-value of the rank-sum test of F. Wilcoxon ("Individual comparisons by ranking methods", Biometrics
/// Bulletin 1, 1945) and of H. B. Mann and D. R. Whitney: the probability that groups of these sizes, drawn at random
/// from all values, have rank sums at least as far from their mean. Equal values share the mean of their ranks. The
/// p-value is exact for up to 100 values; above, it is the normal approximation with correction for ties. It is 1 if a
/// group is empty.
[[nodiscard]] double rank_sum_test(std::span<const double> a, std::span<const double> b);

/// p-values of several tests, corrected after S. Holm ("A simple sequentially rejective multiple test procedure",
/// Scand. J. Statist. 6, 1979): each can be compared with the level of significance of all tests together.
[[nodiscard]] std::vector<double> correct_for_several(std::span<const double> p_values);

}  // namespace proleg::optimize
