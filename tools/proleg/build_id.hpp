#pragma once

namespace proleg::tools {

/// Version and git revision of this build. If files differ from that revision, "-dirty" and a hash of the changes
/// follow, so that builds with the same id have the same code.
extern const char* const build_id;

}  // namespace proleg::tools
