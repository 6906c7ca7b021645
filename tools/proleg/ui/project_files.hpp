#pragma once

// The scenarios that a person can open: those of the project, those opened before, and those that ship with Proleg.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/ui/recent_files.hpp"

namespace proleg::tools {

/// How the names of experiment files end.
inline constexpr const char* experiment_extension = ".optimise.xml";

struct ProjectFile {
  std::string file;   ///< path, in normal form
  std::string group;  ///< the heading under which it stands
  std::string title;
  std::string text;  ///< a sentence; empty: only the file itself has one
  bool is_shipped = false;
  std::int64_t time_ns = 0;  ///< of its last change
};

/// The functions read folders, and may be called by any thread.
class ProjectFiles {
 public:
  /// More scenarios are not listed.
  static constexpr std::size_t max_files = 500;

  /// project: the folder of the project. shipped: the folder sim/scenarios, if there is one.
  ProjectFiles(std::filesystem::path project, std::optional<std::filesystem::path> shipped, RecentFiles recent);

  /// What is there now: first the project's, the newest first; then what was opened before; then what ships with
  /// Proleg. No file is listed twice.
  [[nodiscard]] std::vector<ProjectFile> list() const;

  /// The experiments below the project, and below the shipped scenarios.
  [[nodiscard]] std::vector<ProjectFile> experiments() const;
  /// Whether a path names one that experiments() may have.
  [[nodiscard]] bool has_experiment(const std::string& file) const;

  /// Whether a path names a scenario that list() may have: a regular file below the project, below a project that was
  /// opened before or below the shipped scenarios, or a scenario that was opened before. Symbolic links that lead out
  /// of these folders do not count, nor do hidden folders and folders named build.
  [[nodiscard]] bool has(const std::string& file) const;

  /// The scenarios in a folder and the folders in it, by name; each with the name of the folder.
  [[nodiscard]] static std::vector<std::string> scenarios_in(const std::filesystem::path& folder);

 private:
  std::filesystem::path project_;
  std::optional<std::filesystem::path> shipped_;
  RecentFiles recent_;
};

}  // namespace proleg::tools
