#pragma once

// The searches in the folder of a project, wherever they were started: found by their stores.

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "sim/optimize/evaluation/store_summary.hpp"

namespace proleg::tools {

/// How long evaluations of a search take, by the numbers that were seen in the last minute.
class SearchSpeed {
 public:
  using Clock = std::chrono::steady_clock;

  void note(std::uint64_t made, Clock::time_point now);
  void forget() { seen_.clear(); }
  /// Seconds that so many evaluations take; nothing before two numbers were seen.
  [[nodiscard]] std::optional<double> time_of(std::uint64_t evaluations) const;

 private:
  std::deque<std::pair<Clock::time_point, std::uint64_t>> seen_;
};

/// Searches in a folder and the folders in it. Nothing outside can be reached, also not by symbolic links.
class SearchFolder {
 public:
  using Clock = std::chrono::steady_clock;

  /// The newest of more searches are listed.
  static constexpr std::size_t max_searches = 1000;

  /// Throws InputError if it is no folder.
  explicit SearchFolder(const std::filesystem::path& folder);

  /// An array with an object for each search (docs/page-interface.md, Searches), the newest first. Looks into the
  /// folders again if that was not done just now; of a search that has not changed nothing is read again. Of many new
  /// searches some are "unread": the next list() reads more of them.
  [[nodiscard]] nlohmann::json list(Clock::time_point now = Clock::now());
  /// Whether the last list() had "unread" searches.
  [[nodiscard]] bool has_unread() const { return has_unread_; }
  /// Looks into the folders at the next list() in any case.
  void look_again() { next_walk_ = {}; }

  /// The folder of a search. Throws InputError for a name that list() would not have.
  [[nodiscard]] std::filesystem::path find(const std::string& name) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  [[nodiscard]] static std::filesystem::path store_of(const std::filesystem::path& search);
  /// What `proleg optimise` prints when this program has started it.
  [[nodiscard]] static std::filesystem::path log_of(const std::filesystem::path& search);
  /// The last line of that file, if it says why the search failed; else nothing. That another program was faster to
  /// continue it is no failure of the search.
  [[nodiscard]] static std::string failure_of(const std::filesystem::path& search);

 private:
  /// A store as it was when it was read.
  struct Version {
    std::uint64_t inode = 0;
    std::uint64_t size = 0;
    std::int64_t time_ns = 0;
    bool operator==(const Version&) const = default;
  };
  struct Entry {
    Version version;
    bool is_read = false;
    optimize::StoreSummary summary;
    std::string problem;  ///< why it cannot be read
    SearchSpeed speed;
  };

  void walk();
  [[nodiscard]] static Version version_of(const std::filesystem::path& store);
  static void read(const std::filesystem::path& store, const Version& version, Entry& entry);
  [[nodiscard]] static nlohmann::json object_of(const std::string& name, const std::filesystem::path& search,
                                                const Entry& entry, bool is_running);

  std::filesystem::path folder_;  ///< without symbolic links
  std::map<std::string, Entry> entries_;
  Clock::time_point next_walk_;
  bool has_unread_ = false;
};

}  // namespace proleg::tools
