#pragma once

namespace proleg::tools {

/// Version and git revision of this build. If files differ from that revision, "-dirty" and a hash of the changes
/// follow, so that builds with the same id have the same code.
extern const char* const build_id;

/// Hash of what determines the result of a search: the sources of core, physics and optimiser, the compiler with its
/// flags, and the libraries that compute. Two builds with equal keys give equal results on one kind of processor.
extern const char* const result_key;

}  // namespace proleg::tools
