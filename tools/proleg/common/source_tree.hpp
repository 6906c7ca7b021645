#pragma once

#include <filesystem>
#include <string>

namespace proleg::tools {

/// The checkout of Proleg's sources: `given`, or if that is empty, the one that this program was built in. Throws
/// BadInput, which names the option --source, if there is none.
[[nodiscard]] std::filesystem::path source_tree(const std::string& given);

}  // namespace proleg::tools
