#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// search() for an experiment whose method is PagmoSettings that check_method() accepts, and that has more than one
/// candidate.
///
/// It returns "generations used up", or earlier "converged": when the algorithm has no further requests. An algorithm
/// that stagnates also converges when the whole population is one candidate, or when all requests of a generation lie
/// within half a step of each value set.
[[nodiscard]] std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
