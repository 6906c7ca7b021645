#pragma once

// The documents of a draft, and the changes that its operations ask for (docs/page-interface.md).

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/run_change.hpp"
#include "sim/authoring/world_change.hpp"

namespace proleg::tools {

/// The world of a draft, a part of the document `draft`.
[[nodiscard]] nlohmann::json world_json(const sim::WorldContents& world);

/// The document `library`.
[[nodiscard]] nlohmann::json library_json();

/// How the draft is run, a part of the document `draft`.
[[nodiscard]] nlohmann::json run_json(const sim::Scenario& scenario);

/// What the operation `draft.run` asks for.
struct RunOperation {
  std::string label;  ///< for undo: "duration"
  std::function<void(sim::RunChange&)> change;
};

/// Reads the operation. Throws InputError for a value that does not exist, or of the wrong kind.
[[nodiscard]] RunOperation run_operation(const nlohmann::json& arguments);

/// What an operation of a world asks for.
struct WorldOperation {
  std::string label;  ///< for undo: "move box"
  std::function<void(sim::WorldChange&)> change;
};

/// Reads an operation. Throws InputError for one that does not exist, and for arguments of the wrong kind.
[[nodiscard]] WorldOperation world_operation(const std::string& name, const nlohmann::json& arguments,
                                             const sim::WorldContents& world);

}  // namespace proleg::tools
