#pragma once

// What was opened before: projects and scenarios, in a file of the user that all programs share.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace proleg::tools {

class RecentFiles {
 public:
  static constexpr std::size_t max_entries = 12;

  /// file: where the list is. Without one nothing is kept.
  explicit RecentFiles(std::optional<std::filesystem::path> file) : file_(std::move(file)) {}

  /// Absolute paths of scenarios and folders that exist, the newest first. A damaged file is an empty list.
  [[nodiscard]] std::vector<std::filesystem::path> read() const;
  /// Puts a scenario or a folder in front; the oldest of more than max_entries are forgotten. Another program that
  /// does the same at the same time loses nothing. Throws FileError or std::filesystem::filesystem_error if the list
  /// cannot be written.
  void note(const std::filesystem::path& path) const;

 private:
  std::optional<std::filesystem::path> file_;
};

/// $XDG_STATE_HOME/proleg/recent.json (XDG Base Directory Specification; by default in ~/.local/state); nothing for a
/// user without a home.
[[nodiscard]] std::optional<std::filesystem::path> recent_list_path();

}  // namespace proleg::tools
