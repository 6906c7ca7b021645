#pragma once

namespace proleg::tools {

/// proleg new obstacle: writes an environment file with hills. argv[0] is "obstacle". Returns the exit status.
int new_obstacle(int argc, char** argv);

}  // namespace proleg::tools
