#pragma once

// Documents of the page (docs/page-interface.md) that describe a robot and its parameters.

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/parameter_table.hpp"

namespace proleg::tools {

/// The document `robot`, as JSON. kind: "simulation", "bus" or "recording".
[[nodiscard]] std::string robot_document(const sim::Scenario& scenario, std::string_view kind);

/// The document `parameters`, as JSON.
[[nodiscard]] std::string parameters_document(const sim::Scenario& scenario, const ParameterTable& table);

}  // namespace proleg::tools
