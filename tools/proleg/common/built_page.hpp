#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// A folder with a page beside the build of this program, which tools/page makes. Throws BadInput if it lacks the file.
[[nodiscard]] std::filesystem::path built_page(const std::string& folder, const std::string& file);

}  // namespace proleg::tools
