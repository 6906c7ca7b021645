#include "tools/proleg/ui/recent_files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uint64_t list_format = 1;

/// Keeps other programs from the list while this object lives. If one of them does not let go, it goes on without: then
/// an entry may be lost, but never the list, which is replaced as a whole.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    constexpr int attempts = 50;
    constexpr std::chrono::milliseconds pause{4};
    for (int i = 0; i < attempts && descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0; ++i) {
      std::this_thread::sleep_for(pause);
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// A folder that an environment variable names; the specification ignores relative paths.
std::optional<fs::path> folder_of(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) {
    return std::nullopt;
  }
  return value;
}

json document_in(const fs::path& file) {
  sim::DiskFiles disk;
  return json::parse(disk.read(file).value_or("").str(), nullptr, false);
}

/// The list of a later version is not written: that version would lose it.
void require_no_later_format(const fs::path& file) {
  const json document = document_in(file);
  const json format = document.is_object() ? document.value("format", json()) : json();
  if (format.is_number_unsigned() && format.get<std::uint64_t>() > list_format) {
    throw InputError(file.string(), 0, "format " + format.dump(),
                     std::to_string(list_format) + "; a later version of Proleg has written it");
  }
}

/// All paths of the list, also of what does not exist at present: it may be on a disk that comes back.
std::vector<std::string> paths_in(const fs::path& file) {
  std::vector<std::string> paths;
  const json document = document_in(file);
  if (!document.is_object() || document.value("format", json()) != list_format) {
    return paths;
  }
  for (const json& entry : document.value("paths", json::array())) {
    const std::string path = entry.is_string() ? entry.get<std::string>() : std::string();
    if (fs::path(path).is_absolute() && path.find('\0') == std::string::npos &&
        paths.size() < RecentFiles::max_entries) {
      paths.push_back(path);
    }
  }
  return paths;
}

}  // namespace

std::vector<fs::path> RecentFiles::read() const {
  std::vector<fs::path> existing;
  if (!file_) {
    return existing;
  }
  for (const std::string& path : paths_in(*file_)) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!error && (fs::is_directory(status) || fs::is_regular_file(status))) {
      existing.emplace_back(path);
    }
  }
  return existing;
}

void RecentFiles::note(const fs::path& path) const {
  const std::string noted = fs::absolute(path).lexically_normal().string();
  if (!file_ || find_invalid_utf8(noted)) {  // JSON has no other text
    return;
  }
  fs::create_directories(file_->parent_path());
  const FolderLock lock(file_->parent_path());
  require_no_later_format(*file_);
  std::vector<std::string> paths = paths_in(*file_);
  std::erase(paths, noted);
  paths.insert(paths.begin(), noted);
  paths.resize(std::min(paths.size(), max_entries));
  write_file(*file_, json{{"format", list_format}, {"paths", paths}}.dump(1) + '\n');
}

std::optional<fs::path> recent_list_path() {
  std::optional<fs::path> folder = folder_of("XDG_STATE_HOME");
  if (!folder) {
    folder = folder_of("HOME");
    if (!folder) {
      return std::nullopt;
    }
    *folder /= ".local/state";
  }
  return *folder / "proleg/recent.json";
}

}  // namespace proleg::tools
