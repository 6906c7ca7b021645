#pragma once

// A great deluge on a landscape, without a simulation. Only the source file includes pagmo.

#include <vector>

#include "landscape_problem.hpp"
#include "sim/optimize/method/great_deluge.hpp"

namespace proleg::optimize {

/// The log of a search on a landscape, with one chain for each start; also of one that the landscape ended with
/// SearchEnded.
[[nodiscard]] std::vector<GreatDeluge::LogLine> log_of(const GreatDelugeSettings& settings, const Landscape& landscape,
                                                       const std::vector<std::vector<double>>& starts,
                                                       std::uint64_t seed = 1);

}  // namespace proleg::optimize
