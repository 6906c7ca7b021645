#pragma once

namespace proleg::tools {

/// proleg image info: what the headers of images say. Returns the exit status.
int run_image_info(int argc, char** argv);

}  // namespace proleg::tools
