#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Implements search() for an experiment whose method is MapElitesSettings.
///
/// A generation is drawn from the map as it was before the generation before it: workers rate one while the next is
/// known already, and it makes no difference how many workers there are. The second and the third generation are drawn
/// from the map of the first.
///
/// A new candidate is drawn from two candidates of the map, each with the same probability (p and q):
///     value[i] = p[i] + noise * (n[i] - 1) * N[i] + line * N * (q[i] - p[i])
/// rounded and cut to the values of the dimension, where n[i] is their number, and N[i] and N are normal. If it equals
/// p, one of its values is drawn again from all others.
[[nodiscard]] std::string search_map_elites(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
