#pragma once

namespace proleg::tools {

/// proleg image make: puts a header in front of a program. Returns the exit status.
int run_image_make(int argc, char** argv);

}  // namespace proleg::tools
