#pragma once

#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::tools {

/// Drives a robot without modules, by the plug-in that its file names. Returns the exit status.
int drive_by_plugin(const ScenarioOptions& options, const ScenarioRun& run);

}  // namespace proleg::tools
