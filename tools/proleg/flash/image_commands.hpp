#pragma once

namespace proleg::tools {

/// proleg image info: what the headers of images say. Returns the exit status.
int run_image_info(int argc, char** argv);

/// proleg image make: puts a header in front of a program. Returns the exit status.
int run_image_make(int argc, char** argv);

}  // namespace proleg::tools
