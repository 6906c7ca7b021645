#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// The name of a file that belongs to a recording: run.svg for run.proleg. Only the usual extension of recordings is
/// replaced, so that run.1 and run.2 do not share a file.
[[nodiscard]] inline std::filesystem::path beside_recording(const std::filesystem::path& recording,
                                                            const std::string& extension) {
  return recording.extension() == ".proleg" ? std::filesystem::path(recording).replace_extension(extension)
                                            : std::filesystem::path(recording.string() + extension);
}

}  // namespace proleg::tools
