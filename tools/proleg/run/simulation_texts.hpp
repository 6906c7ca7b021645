#pragma once

// The command that simulates a scenario, and the results of a simulation as texts.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The line for a shell that simulates a scenario, with the libraries of users' algorithms that are loaded. settings,
/// moves: arguments of --set and --move.
[[nodiscard]] std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                                           const std::vector<std::string>& settings,
                                           const std::vector<std::string>& moves);

/// The results of a run, as its recording keeps them. lost_frames: number of frames lost in the whole run. Must be
/// called after a tick.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> results_of(const sim::Simulation& simulation,
                                                                          const sim::Scenario& scenario,
                                                                          std::uint64_t lost_frames);

}  // namespace proleg::tools
