#pragma once

// A scenario whose files are copied into a new folder.

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Writes the files into a new folder, in the folders below it that they had below their common one. Returns the new
/// name of each by its name. Throws InputError if the folder exists, FileError if it cannot be written; then there is
/// no new folder.
std::map<std::string, std::string> copy_sources(std::span<const sim::SourceFile> sources,
                                                const std::filesystem::path& folder);

/// The folder with this name below `parent`, for new files. argument: what has named it. Throws InputError if it is no
/// short name without a path.
[[nodiscard]] std::filesystem::path new_folder_in(const std::filesystem::path& parent, const std::string& name,
                                                  const char* argument);

}  // namespace proleg::tools
