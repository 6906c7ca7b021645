#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace proleg::host {

struct PageFile {
  std::string_view content_type;
  std::string bytes;
};

/// Files that a server reads when they are asked for, because most of them never are. It finds them by the path that
/// they had at the start, so no path leads out of the folder.
class DocumentFiles {
 public:
  /// Has no files.
  DocumentFiles() = default;
  /// The files of a folder and its subfolders below a path such as "/docs/", which is its index.html. Leaves out what
  /// is neither a file nor a folder. Throws FileError.
  DocumentFiles(const std::filesystem::path& folder, const std::string& below);

  /// The file of a path such as "/docs/first-steps.html"; nothing if there is none, or none any more.
  [[nodiscard]] std::optional<PageFile> read(std::string_view path) const;

 private:
  std::map<std::string, std::filesystem::path, std::less<>> paths_;
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
