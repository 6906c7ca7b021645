#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace proleg::host {

struct PageFile {
  std::string_view content_type;
  std::string bytes;
};

/// The files of the page, in memory. A request finds a file by its whole path, so no path leads out of the folder.
class PageFiles {
 public:
  /// Has no files.
  PageFiles() = default;
  /// Reads a folder with index.html, with its subfolders: regular files of known types, 64 MiB together. Throws
  /// InputError or FileError.
  explicit PageFiles(const std::filesystem::path& folder);

  /// The file of a path such as "/app.js"; "/" is index.html. Null if there is none. The pointer is valid as long as
  /// this object.
  [[nodiscard]] const PageFile* find(std::string_view path) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

}  // namespace proleg::host
