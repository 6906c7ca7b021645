#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// The checkout of Proleg's sources: `given`, or if that is empty, the checkout in which this program was built. Throws
/// BadInput, which names the option --source, if no checkout is found.
[[nodiscard]] std::filesystem::path source_tree(const std::string& given);

/// A folder with a page beside the build of this program, which tools/page makes. Throws BadInput if it lacks the file.
[[nodiscard]] std::filesystem::path built_page(const std::string& folder, const std::string& file);

}  // namespace proleg::tools
