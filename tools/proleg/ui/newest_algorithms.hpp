#pragma once

// Scenarios whose algorithms were loaded again since they were read.

#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Whether a slot of the scenario has an algorithm of which the program has loaded a newer version.
[[nodiscard]] bool has_newer_algorithms(const sim::Scenario& scenario);

/// Takes the newest versions of all algorithms whose parameters and internal values are the same as before: the values
/// of the scenario still fit. Returns the names of the others, which stay.
std::vector<std::string> take_newest_algorithms(sim::Scenario& scenario);

}  // namespace proleg::tools
