#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The results of a run, as its recording keeps them. lost_frames: number of frames lost in the whole run. Must be
/// called after a tick.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> results_of(const sim::Simulation& simulation,
                                                                          const sim::Scenario& scenario,
                                                                          std::uint64_t lost_frames);

}  // namespace proleg::tools
