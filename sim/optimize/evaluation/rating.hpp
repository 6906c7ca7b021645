#pragma once

#include <span>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// The evaluation that the trials of a candidate give. trials: all of them, in their order; at least one.
[[nodiscard]] Evaluation rate(const Experiment& experiment, std::uint32_t run, std::uint64_t number,
                              const Candidate& candidate, std::span<const TrialResult> trials);

}  // namespace proleg::optimize
