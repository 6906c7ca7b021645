#pragma once

namespace proleg::tools {

/// The program `proleg new obstacle`, from its own name on. Returns the exit status.
int new_obstacle(int argc, char** argv);

}  // namespace proleg::tools
