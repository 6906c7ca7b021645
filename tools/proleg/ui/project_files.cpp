#include "tools/proleg/ui/project_files.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/ui/folder_walk.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

bool is_entered(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return !name.starts_with('.') && name != "build";
}

bool is_file_with(const char* extension, const fs::path& path) {
  std::error_code error;
  return path.string().ends_with(extension) && !find_invalid_utf8(path.string()) && fs::is_regular_file(path, error) &&
         !error;
}

bool is_scenario(const fs::path& path) { return is_file_with(scenario_extension, path); }

/// The path without symbolic links; empty if it cannot be followed.
fs::path real_path(const fs::path& path) {
  std::error_code error;
  fs::path real = fs::canonical(path, error);
  return error ? fs::path() : real;
}

/// Whether a file is below a folder, in folders that a scan enters. Both without symbolic links.
bool is_below(const fs::path& file, const fs::path& folder) {
  if (file.empty() || folder.empty()) {
    return false;
  }
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (end != folder.end() || rest == file.end()) {
    return false;
  }
  int depth = 0;
  for (auto part = rest; std::next(part) != file.end(); ++part, ++depth) {
    if (!is_entered(*part)) {
      return false;
    }
  }
  return depth <= max_folder_depth;
}

/// The files in a folder and the folders in it, by name; each with the name of the folder.
std::vector<std::string> files_in(const fs::path& folder, const char* extension) {
  std::vector<std::string> files;
  const fs::path real = real_path(folder);
  const auto add = [&](const fs::path& path) {
    if (files.size() < ProjectFiles::max_files && is_file_with(extension, path) && is_below(real_path(path), real)) {
      files.push_back(path.lexically_normal().string());
    }
  };
  for_each_path(folder, add, is_entered);
  std::ranges::sort(files);
  return files;
}

std::int64_t time_of(const fs::path& path) {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(path, error);
  return error ? 0 : std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

/// "wave/uniform" for a scenario in a folder.
std::string title_of(const fs::path& file, const fs::path& folder, std::string_view extension = scenario_extension) {
  std::string title = file.lexically_relative(folder).string();
  title.resize(title.size() - extension.size());
  return one_line(title);
}

/// Collects files, each once.
class FileList {
 public:
  [[nodiscard]] bool is_full() const { return files_.size() >= ProjectFiles::max_files; }
  void add(ProjectFile file) {
    if (!is_full() && known_.insert(real_path(file.file).string()).second) {
      files_.push_back(std::move(file));
    }
  }
  void add_folder(const fs::path& folder, const std::string& group) {
    std::vector<ProjectFile> found;
    for (const std::string& file : ProjectFiles::scenarios_in(folder)) {
      found.push_back({file, group, title_of(file, folder), {}, false, time_of(file)});
    }
    std::ranges::stable_sort(found, std::greater(), &ProjectFile::time_ns);
    for (ProjectFile& file : found) {
      add(std::move(file));
    }
  }
  /// This file stands elsewhere in the list.
  void leave_out(const fs::path& file) { known_.insert(real_path(file).string()); }
  std::vector<ProjectFile> take() { return std::move(files_); }

 private:
  std::vector<ProjectFile> files_;
  std::set<std::string> known_;
};

}  // namespace

ProjectFiles::ProjectFiles(fs::path project, std::optional<fs::path> shipped, RecentFiles recent)
    : project_(std::move(project)), shipped_(std::move(shipped)), recent_(std::move(recent)) {}

std::vector<std::string> ProjectFiles::scenarios_in(const fs::path& folder) {
  return files_in(folder, scenario_extension);
}

std::vector<ProjectFile> ProjectFiles::experiments() const {
  std::vector<ProjectFile> experiments;
  const auto add = [&](const fs::path& folder, bool is_shipped) {
    for (const std::string& file : files_in(folder, experiment_extension)) {
      experiments.push_back({file, {}, title_of(file, folder, experiment_extension), {}, is_shipped, 0});
    }
  };
  add(project_, false);
  if (shipped_) {
    add(*shipped_, true);
  }
  return experiments;
}

bool ProjectFiles::has_experiment(const std::string& file) const {
  if (file.find('\0') != std::string::npos || !is_file_with(experiment_extension, file)) {
    return false;
  }
  const fs::path real = real_path(file);
  return is_below(real, real_path(project_)) || (shipped_ && is_below(real, real_path(*shipped_)));
}

std::vector<ProjectFile> ProjectFiles::list() const {
  FileList list;
  std::vector<ProjectFile> shipped;
  if (shipped_) {
    for (const ShippedScenario& scenario : shipped_scenarios()) {
      const fs::path path = *shipped_ / (std::string(scenario.file) + scenario_extension);
      if (is_scenario(path)) {
        shipped.push_back({path.lexically_normal().string(), std::string(scenario.group), std::string(scenario.title),
                           std::string(scenario.text), true, 0});
        list.leave_out(path);
      }
    }
  }
  list.add_folder(project_, "My project");
  const std::string last = "Last";
  for (const fs::path& path : recent_.read()) {
    if (is_scenario(path)) {
      list.add({path.string(), last, title_of(path, path.parent_path()), {}, false, time_of(path)});
    } else {
      std::error_code error;
      if (fs::is_directory(path, error)) {
        list.add_folder(path, last + ": " + one_line(path.filename().string()));
      }
    }
  }
  std::vector<ProjectFile> files = list.take();
  files.insert(files.end(), shipped.begin(), shipped.end());
  return files;
}

bool ProjectFiles::has(const std::string& file) const {
  if (file.find('\0') != std::string::npos || !is_scenario(file)) {
    return false;
  }
  const fs::path real = real_path(file);
  if (is_below(real, real_path(project_)) || (shipped_ && is_below(real, real_path(*shipped_)))) {
    return true;
  }
  return std::ranges::any_of(recent_.read(), [&](const fs::path& recent) {
    const fs::path other = real_path(recent);
    return real == other || is_below(real, other);
  });
}

}  // namespace proleg::tools
