#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// search() for an experiment whose method is GreatDelugeSettings, with one objective and more than one candidate.
/// It returns "no credit left" or "target reached".
[[nodiscard]] std::string search_great_deluge(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
