#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// How a robot moves in a scenario, for a picture that moves (docs/page-interface.md, `search.motion`): its joints and
/// its head, at least 20 ms from row to row, for at most 30 s of the run. Ends earlier if the simulation fails, has
/// taken `longest` of the processor, or is_outdated() returns true.
[[nodiscard]] std::vector<std::uint8_t> gait_motion(const sim::Scenario& scenario, std::chrono::milliseconds longest,
                                                    const std::function<bool()>& is_outdated);

}  // namespace proleg::tools
