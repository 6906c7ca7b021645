#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Evaluates the baseline, if the experiment has one, and runs the method until it ends; returns why it ended ("no
/// credit left", "converged", ...). Its requests depend only on the experiment, the run and the scores. SearchEnded
/// passes through. Throws InputError for settings that the method rejects (a population that is too small, several
/// objectives for a method with one).
[[nodiscard]] std::string search(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
