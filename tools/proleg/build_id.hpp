#pragma once

namespace proleg::tools {

/// Version and git revision of this build. What is not committed counts: "-dirty" is followed by a hash of the changes,
/// so that two builds with the same id are the same code.
extern const char* const build_id;

}  // namespace proleg::tools
