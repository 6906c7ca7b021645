#pragma once

// The best candidates of a search, rated again in fresh runs. Two results need it. The best score of many noisy ones is
// too good: part of it is chance, and fresh runs do not have this bias. And what an engine that is not the judging one
// found may live on its errors, so fresh runs are made in that one.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

/// A candidate with the scores of its fresh runs, by the first objective.
struct Confirmation {
  Evaluation evaluation;       ///< in the search
  std::vector<double> scores;  ///< of each fresh run; at least one
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< of the runs (divisor n - 1); 0 for one run
  double worst = 0.0;
  Evaluation fresh{};  ///< the candidate as the fresh runs alone rate it
};

/// Whether the search is judged; or its result depends on random numbers, and the experiment asks for fresh runs.
/// A robot makes none.
[[nodiscard]] bool needs_confirmation(const Experiment& experiment);

/// The fresh runs of the experiment. Of a judged search at least ten candidates have one: with equal runs, exactly one.
[[nodiscard]] ConfirmationSettings fresh_runs(const Experiment& experiment);

/// The best different candidates of a search that have scores, best first, at most `count`. evaluations: of one run, by
/// number.
[[nodiscard]] std::vector<Evaluation> best_candidates(const Experiment& experiment,
                                                      std::span<const Evaluation> evaluations, std::size_t count);

/// Chooses as many finalists as fresh_runs() says; and the baseline, if it has a score.
[[nodiscard]] std::vector<Evaluation> choose_finalists(const Experiment& experiment,
                                                       std::span<const Evaluation> evaluations);

/// Simulates each finalist in the same fresh worlds: trials with the numbers after those of the search, in the judging
/// engine. Best first, by the aggregate of the experiment's trials (the mean, or the worst). The result does not depend
/// on the number of workers; what the store has is not simulated again. store: null for none. stop: called often with
/// the number of simulations that are done and of all; when it returns true, this throws SearchEnded.
[[nodiscard]] std::vector<Confirmation> confirm(const Experiment& experiment, std::span<const Evaluation> finalists,
                                                Workers& workers, Store* store,
                                                const std::function<bool(std::size_t done, std::size_t all)>& stop);

}  // namespace proleg::optimize
