#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// Where a new recording with this name goes. Throws InputError for a name that is no plain file name with .proleg, and
/// if there is such a file.
[[nodiscard]] std::filesystem::path new_recording(const std::filesystem::path& folder, const std::string& name);

}  // namespace proleg::tools
