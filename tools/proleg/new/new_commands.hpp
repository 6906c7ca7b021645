#pragma once

namespace proleg::tools {

/// proleg new algorithm: writes the folder of a user's algorithm. argv[0] is "algorithm". Returns the exit status.
int new_algorithm(int argc, char** argv);

/// proleg new obstacle: writes an environment file with hills. argv[0] is "obstacle". Returns the exit status.
int new_obstacle(int argc, char** argv);

}  // namespace proleg::tools
