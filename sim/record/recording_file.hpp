#pragma once

#include <filesystem>

namespace proleg::sim {

/// Creates an empty file for a new recording, in place of an empty file or an earlier recording. Throws FileError if
/// anything else is there, or a recording that is being written at this moment, or if the system refuses.
void claim_recording_file(const std::filesystem::path& path);

}  // namespace proleg::sim
