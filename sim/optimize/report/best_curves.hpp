#pragma once

// The course of repeated searches: the best score so far after each evaluation. More is better.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// All repetitions of the experiment with one method.
struct MethodRuns {
  std::string method;                         ///< method_name()
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

}  // namespace proleg::optimize
