#pragma once

// Writes the files of `proleg new`.

#include <filesystem>
#include <span>
#include <string>

namespace proleg::tools {

struct NewFile {
  std::string name;  ///< path relative to the folder
  std::string text;
};

/// Writes all files, and a line for each on standard output. Throws BadInput, before it writes a file, if one of them
/// exists; and InputError if the folder has no name.
void write_new_files(const std::filesystem::path& folder, std::span<const NewFile> files);

}  // namespace proleg::tools
