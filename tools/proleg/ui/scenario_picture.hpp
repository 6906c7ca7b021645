#pragma once

// A small picture of a scenario: the robot in the last stride of its first seconds, on a strip of the world, with the
// way of its head.

#include <nlohmann/json_fwd.hpp>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/gait_preview.hpp"

namespace proleg::tools {

/// `picture` of the document `gallery` (docs/page-interface.md): whole numbers of a picture 1000 wide and 500 high, y
/// downwards. It has at most about 3 kB.
[[nodiscard]] nlohmann::json picture_json(const sim::Scenario& scenario, const GaitPreview& preview);

}  // namespace proleg::tools
