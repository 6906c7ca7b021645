#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// The checkout of Proleg's sources: `given`, or if that is empty, the checkout in which this program was built. Throws
/// BadInput, which names the option --source, if no checkout is found.
[[nodiscard]] std::filesystem::path source_tree(const std::string& given);

}  // namespace proleg::tools
