#pragma once

// Documents of the page (docs/page-interface.md) that describe a robot and its parameters.

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/document/parameter_table.hpp"

namespace proleg::tools {

/// A pose as [x, y, z, qw, qx, qy, qz].
[[nodiscard]] nlohmann::json pose_json(const sim::Pose& pose);

/// The document `robot`. kind: "simulation", "bus" or "recording".
[[nodiscard]] nlohmann::json robot_document(const sim::Scenario& scenario, std::string_view kind);

/// The document `parameters`.
[[nodiscard]] nlohmann::json parameters_document(const sim::Scenario& scenario, const ParameterTable& table);

}  // namespace proleg::tools
