#pragma once

// The reports of the master as text of one line for a person. The simulator's host node and the host programs print it.

#include <cstdint>
#include <functional>
#include <string>

#include "shared/computer/master/master_report.hpp"

namespace proleg {

/// The name of a node in a message: "node 3 (J3)".
using NodeName = std::function<std::string(std::uint8_t node)>;

/// Text of the problem that ended the start, or of the first problem in flight: the module, what was found and what was
/// expected. problem: with a code other than `none`.
[[nodiscard]] std::string problem_text(const canopen::Problem& problem, const NodeName& name);

/// Text of an event.
[[nodiscard]] std::string event_text(const canopen::Event& event, const NodeName& name);

}  // namespace proleg
