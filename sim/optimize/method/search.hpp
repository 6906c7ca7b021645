#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Runs the method of an experiment until it ends by itself; returns why ("no credit left", "converged", ...). What it
/// asks for depends on the experiment, the run and the scores alone. SearchEnded passes through. Throws InputError for
/// settings that the method refuses (a population that is too small, several objectives for a method that knows one).
[[nodiscard]] std::string search(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

/// Evaluations that a search makes if it does not end before: those of its budget, or of its generations if they are
/// fewer. 0: nobody knows.
[[nodiscard]] std::uint64_t planned_evaluations(const Experiment& experiment);

/// Throws InputError as search() would, before anything is evaluated.
void check_method(const Experiment& experiment);

}  // namespace proleg::optimize
