#pragma once

namespace proleg::tools {

/// proleg new algorithm: writes the folder of a user's algorithm. argv[0] is "algorithm". Returns the exit status.
int new_algorithm(int argc, char** argv);

}  // namespace proleg::tools
