#pragma once

#include <string>
#include <vector>

#include "sim/scenario/overrides.hpp"

namespace proleg::tools {

/// The line for a shell that simulates a scenario, with the libraries of users' algorithms that are loaded. settings,
/// moves: arguments of --set and --move.
[[nodiscard]] std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                                           const std::vector<std::string>& settings,
                                           const std::vector<std::string>& moves);

}  // namespace proleg::tools
