#pragma once

// A scenario that a person begins with: the operation draft.new (docs/page-interface.md).

#include <nlohmann/json_fwd.hpp>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The scenario that the arguments of draft.new describe, with its files, none of which is on disk: a kind of robot,
/// the axes of its joints, a name, an algorithm, and what stands in its way. Throws InputError.
[[nodiscard]] sim::Scenario new_scenario(const nlohmann::json& arguments);

}  // namespace proleg::tools
