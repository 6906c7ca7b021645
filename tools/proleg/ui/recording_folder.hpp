#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace proleg::tools {

/// The recordings in a folder and the folders in it. Nothing outside can be reached, also not by symbolic links.
class RecordingFolder {
 public:
  /// The newest of more files are listed: a list of all goes to the page every two seconds.
  static constexpr std::size_t max_files = 5000;

  /// Throws InputError if it is no folder.
  explicit RecordingFolder(const std::filesystem::path& folder);

  /// An array with an object for each file (docs/page-interface.md, Recordings), the newest first. What has to be read
  /// from the files is null until describe_some() has read it.
  [[nodiscard]] nlohmann::json list();
  /// Reads one file of the last list(), the newest first; false if all are read.
  bool describe_some();

  /// The file that a name of the list means. Throws InputError for anything else.
  [[nodiscard]] std::filesystem::path find(const std::string& name) const;

 private:
  /// A file as it was when it was described.
  struct Version {
    std::uint64_t size = 0;
    std::int64_t time_ns = 0;
    bool operator==(const Version&) const = default;
  };
  struct Entry {
    Version version;
    bool is_described = false;
    nlohmann::json description;
  };

  [[nodiscard]] static Version version_of(const std::filesystem::path& path, const std::set<std::string>& companions);

  std::filesystem::path folder_;  ///< without symbolic links
  std::map<std::string, Entry> entries_;
  std::vector<std::string> undescribed_;  ///< names, the newest last
};

/// Where a new recording with this name goes. Throws InputError for a name that is no plain file name with .proleg, and
/// if there is such a file.
[[nodiscard]] std::filesystem::path new_recording(const std::filesystem::path& folder, const std::string& name);

}  // namespace proleg::tools
