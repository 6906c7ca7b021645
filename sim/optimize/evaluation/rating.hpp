#pragma once

#include <span>
#include <string>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// The evaluation that the trials of a candidate give. trials: all of them, in their order; at least one.
[[nodiscard]] Evaluation rate(const Experiment& experiment, std::uint32_t run, std::uint64_t number,
                              const Candidate& candidate, std::span<const TrialResult> trials);

/// Whether the score of an objective comes from measures, and not from a failure or a measure that is not defined.
[[nodiscard]] bool has_own_score(const Experiment& experiment, const Evaluation& evaluation, std::size_t objective);

/// Why an evaluation has no score of its own for the first objective: its failure, or the measures that its run does
/// not define.
[[nodiscard]] std::string why_without_score(const Experiment& experiment, const Evaluation& evaluation);

/// Whether an evaluation is better than another by the first objective, and has a score that a run can repeat: its own,
/// and not extrapolated by racing. Without another one: whether it has such a score.
[[nodiscard]] bool is_better(const Experiment& experiment, const Evaluation& evaluation, const Evaluation* other);

/// The evaluation of the scenario's own values; null if there is none. evaluations: of one run, by number.
[[nodiscard]] const Evaluation* baseline_of(const Experiment& experiment, std::span<const Evaluation> evaluations);

}  // namespace proleg::optimize
