#pragma once

// What the master reports, as one line for a person. The simulator's host node and the host programs print it.

#include <cstdint>
#include <functional>
#include <string>

#include "shared/computer/master/master_report.hpp"

namespace proleg {

/// The name of a node in a message: "node 3 (J3)".
using NodeName = std::function<std::string(std::uint8_t node)>;

/// Why the start failed, or the first problem in flight: the module, what was found and what was expected.
/// problem: with a code other than `none`.
[[nodiscard]] std::string problem_text(const canopen::Problem& problem, const NodeName& name);

/// What happened on the way.
[[nodiscard]] std::string event_text(const canopen::Event& event, const NodeName& name);

}  // namespace proleg
