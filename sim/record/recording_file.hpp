#pragma once

#include <filesystem>

namespace proleg::sim {

/// Creates an empty file for a new recording. Replaces an empty file or an earlier recording. Throws FileError for any
/// other existing file, for a recording into which another program is writing, and if the system cannot create the
/// file.
void claim_recording_file(const std::filesystem::path& path);

}  // namespace proleg::sim
