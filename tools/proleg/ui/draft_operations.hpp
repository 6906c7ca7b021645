#pragma once

// The changes of a draft that operations ask for (docs/page-interface.md).

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sim/authoring/draft.hpp"

namespace proleg::tools {

struct DraftOperation {
  std::string label;  ///< for undo: "move box"
  std::function<void(sim::DraftChange&)> change;
  /// Afterwards a position in one of the draft's lists can mean something else.
  bool moves_positions = false;
  /// It names a part of the draft by its position in a list.
  bool names_positions = true;
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
[[nodiscard]] DraftOperation run_operation(const std::string& name, const nlohmann::json& arguments,
                                           const sim::Draft& draft);

class SentMeshes;
/// Those that use a mesh that was sent: "robot.own_module", "world.add_mesh".
[[nodiscard]] DraftOperation mesh_operation(const std::string& name, const nlohmann::json& arguments,
                                            const sim::Draft& draft, const SentMeshes& meshes);
/// Whether mesh_operation() reads it.
[[nodiscard]] bool names_sent_mesh(std::string_view operation);

using DraftOperationReader = DraftOperation (*)(const std::string& name, const nlohmann::json& arguments,
                                                const sim::Draft& draft);
/// Which of them reads an operation; null: none.
[[nodiscard]] DraftOperationReader reader_of(std::string_view operation);

}  // namespace proleg::tools
