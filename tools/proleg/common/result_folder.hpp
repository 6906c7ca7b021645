#pragma once

// The folder (--out) into which a search, a sweep or an experiment writes its files.

#include <filesystem>
#include <span>
#include <string_view>

namespace proleg::tools {

/// Throws InputError if the folder cannot be made or written in, and BadInput if one of the files exists in it: results
/// replace only their own files. To be called before the work begins.
void check_result_folder(const std::filesystem::path& folder, std::span<const std::string_view> files);

/// Creates the folder. Throws BadInput.
void create_result_folder(const std::filesystem::path& folder);

}  // namespace proleg::tools
