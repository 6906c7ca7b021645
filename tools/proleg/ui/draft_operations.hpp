#pragma once

// The changes of a draft that operations ask for (docs/page-interface.md).

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/authoring/draft.hpp"

namespace proleg::tools {

struct DraftOperation {
  std::string label;  ///< for undo: "move box"
  std::function<void(sim::DraftChange&)> change;
  /// Afterwards a position in one of the draft's lists can mean something else.
  bool moves_positions = false;
};

// Each function reads an operation. All throw InputError for one that does not exist, and for arguments of the wrong
// kind.

/// "world.": objects, rulers, the start of the robot.
[[nodiscard]] DraftOperation world_operation(const std::string& name, const nlohmann::json& arguments,
                                             const sim::Draft& draft);
/// "robot.": joints, links, servos, sensors.
[[nodiscard]] DraftOperation robot_operation(const std::string& name, const nlohmann::json& arguments,
                                             const sim::Draft& draft);
/// "behaviour.": actuation modules and their parameters.
[[nodiscard]] DraftOperation behaviour_operation(const std::string& name, const nlohmann::json& arguments,
                                                 const sim::Draft& draft);
/// "draft.run": how the draft is run.
[[nodiscard]] DraftOperation run_operation(const nlohmann::json& arguments, const sim::Draft& draft);

}  // namespace proleg::tools
