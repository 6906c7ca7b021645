#pragma once

// The documents of a draft (docs/page-interface.md).

#include <nlohmann/json_fwd.hpp>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/world_contents.hpp"

namespace proleg::tools {

// Parts of the document `draft`.

[[nodiscard]] nlohmann::json world_json(const sim::WorldContents& world);
[[nodiscard]] nlohmann::json robot_json(const sim::RobotContents& robot, const sim::Scenario& scenario);
[[nodiscard]] nlohmann::json behaviour_json(const sim::Scenario& scenario);
[[nodiscard]] nlohmann::json run_json(const sim::Scenario& scenario);

/// The document `library`: what a world can get.
[[nodiscard]] nlohmann::json library_json();
/// The document `parts`: what a robot can get.
[[nodiscard]] nlohmann::json parts_json();

}  // namespace proleg::tools
