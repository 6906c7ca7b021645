#pragma once

// The sweeps in the folder of a project, wherever they were started: found by their tables and requests.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim/optimize/sweep/sweep_request.hpp"
#include "tools/proleg/ui/search_folder.hpp"

namespace proleg::tools {

/// A sweep as its folder describes it.
struct NotedSweep {
  optimize::SweepRequest request;
  optimize::Sweep outline;  ///< without its scenario
};

/// Sweeps in a folder and the folders in it. Nothing outside can be reached, also not by symbolic links.
class SweepFolder {
 public:
  using Clock = std::chrono::steady_clock;

  /// The newest of more sweeps are listed.
  static constexpr std::size_t max_sweeps = 1000;

  /// Throws InputError if it is no folder.
  explicit SweepFolder(const std::filesystem::path& folder);

  /// An array with an object for each sweep (docs/page-interface.md, Sweeps), the newest first. Of a sweep that has
  /// grown only the new part of its table is looked at.
  [[nodiscard]] nlohmann::json list(Clock::time_point now = Clock::now());
  /// Looks into the folders at the next list() in any case.
  void look_again() { next_walk_ = {}; }

  /// The folder of a sweep. Throws InputError for a name that list() would not have.
  [[nodiscard]] std::filesystem::path find(const std::string& name) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// Throws InputError if the folder has none, or one that this version does not read.
  [[nodiscard]] static NotedSweep note_of(const std::filesystem::path& sweep);
  [[nodiscard]] static std::filesystem::path table_of(const std::filesystem::path& sweep);
  [[nodiscard]] static std::filesystem::path request_of(const std::filesystem::path& sweep);
  /// What `proleg sweep` prints when this program has started it.
  [[nodiscard]] static std::filesystem::path log_of(const std::filesystem::path& sweep);
  /// The last line of that file, if it says why the sweep failed; else nothing.
  [[nodiscard]] static std::string failure_of(const std::filesystem::path& sweep);

 private:
  struct Version {
    std::uint64_t inode = 0;
    std::uint64_t size = 0;
    std::int64_t time_ns = 0;
    bool operator==(const Version&) const = default;
  };
  struct Entry {
    Version request_version;
    NotedSweep note;
    std::string problem;  ///< why it cannot be read
    Version table_version;
    std::uint64_t lines = 0;  ///< of the table, as far as it was looked at
    SearchSpeed speed;
  };

  void walk();
  [[nodiscard]] static Version version_of(const std::filesystem::path& file);
  static void read_request(const std::filesystem::path& sweep, Entry& entry);
  static void count_lines(const std::filesystem::path& sweep, Entry& entry);
  [[nodiscard]] static nlohmann::json object_of(const std::string& name, const std::filesystem::path& sweep,
                                                Entry& entry, Clock::time_point now);

  std::filesystem::path folder_;  ///< without symbolic links
  std::map<std::string, Entry> entries_;
  Clock::time_point next_walk_;
};

}  // namespace proleg::tools
