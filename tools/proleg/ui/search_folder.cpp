#include "tools/proleg/ui/search_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "tools/proleg/ui/command_sequence.hpp"
#include "tools/proleg/ui/folder_walk.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* store_name = "store.sqlite";

/// A list comes in this time, also of many searches; the rest of it comes later.
constexpr std::chrono::milliseconds time_to_read{50};

std::int64_t modified_ns(const struct stat& status) {
  constexpr std::int64_t second = 1'000'000'000;
  return status.st_mtim.tv_sec * second + status.st_mtim.tv_nsec;
}

/// 0 if there is no such file.
std::int64_t modified_ns(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? modified_ns(status) : 0;
}

}  // namespace

void SearchSpeed::note(std::uint64_t made, Clock::time_point now) {
  constexpr std::chrono::minutes memory{1};
  if (!seen_.empty() && made < seen_.back().second) {
    seen_.clear();
  }
  while (seen_.size() > 2 && now - seen_[1].first > memory) {
    seen_.pop_front();
  }
  seen_.emplace_back(now, made);
}

std::optional<double> SearchSpeed::time_of(std::uint64_t evaluations) const {
  if (seen_.size() < 2 || seen_.back().second <= seen_.front().second) {
    return std::nullopt;
  }
  const double seconds = std::chrono::duration<double>(seen_.back().first - seen_.front().first).count();
  return static_cast<double>(evaluations) * seconds / static_cast<double>(seen_.back().second - seen_.front().second);
}

SearchFolder::SearchFolder(const fs::path& folder) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(folder_, error)) {
    throw InputError(folder.string(), 0, error ? error.message() : "no folder", "a folder with searches");
  }
}

fs::path SearchFolder::store_of(const fs::path& search) { return search / store_name; }
fs::path SearchFolder::log_of(const fs::path& search) { return search / "search.log"; }

std::string SearchFolder::failure_of(const fs::path& search) {
  const std::string last = last_line_of_file(log_of(search));
  constexpr std::string_view program = "proleg optimise: ";
  const bool is_failure = last.starts_with(program) && last.find(": interrupted ") == std::string::npos &&
                          last.find(optimize::another_writer) == std::string::npos;
  return is_failure ? last.substr(program.size()) : std::string();
}

/// Of a store that is written the newest part is in a file beside it.
SearchFolder::Version SearchFolder::version_of(const fs::path& store) {
  Version version;
  for (const char* suffix : {"-wal", ""}) {
    struct stat status {};
    if (::stat((store.string() + suffix).c_str(), &status) == 0) {
      version.inode = status.st_ino;
      version.size += static_cast<std::uint64_t>(status.st_size);
      version.time_ns = std::max(version.time_ns, modified_ns(status));
    }
  }
  return version;
}

void SearchFolder::walk() {
  std::vector<std::string> before;
  for (const auto& [name, entry] : entries_) {
    before.push_back(name);
  }
  constexpr const char* marks[] = {store_name};
  std::map<std::string, Entry> found;
  for (const std::string& name : folders_with(folder_, marks, before)) {
    found[name] = std::move(entries_[name]);
  }
  entries_ = std::move(found);
}

void SearchFolder::read(const fs::path& store, const Version& version, Entry& entry) {
  try {
    entry.summary =
        optimize::read_store_summary(store, entry.is_read && entry.problem.empty() ? &entry.summary : nullptr);
    entry.problem.clear();
  } catch (const std::exception& error) {
    entry.problem = one_line(error.what());
  }
  entry.version = version;
  entry.is_read = true;
}

json SearchFolder::object_of(const std::string& name, const fs::path& search, const Entry& entry, bool is_running) {
  const optimize::StoreSummary& summary = entry.summary;
  json object{{"name", name},      {"state", entry.is_read ? "unreadable" : "unread"},
              {"method", ""},      {"scenario", ""},
              {"started", ""},     {"made", 0},
              {"planned", json()}, {"best", json()},
              {"score", json()},   {"objective", ""},
              {"unit", ""},        {"left_s", json()},
              {"ending", json()},  {"problem", text_or_null(entry.problem)}};
  if (!entry.is_read || !entry.problem.empty()) {
    return object;
  }
  object["state"] = is_running       ? optimize::is_stop_requested(store_of(search)) ? "stopping" : "running"
                    : summary.ending ? "ended"
                                     : "interrupted";
  object["method"] = one_line(summary.method);
  object["scenario"] = one_line(fs::path(summary.scenario).filename().string());
  object["started"] = one_line(summary.started);
  object["made"] = summary.made;
  object["planned"] = summary.planned > 0 ? json(summary.planned * summary.runs) : json();
  object["best"] = summary.best ? json(*summary.best) : json();
  object["score"] = summary.best ? json(summary.best_score) : json();
  object["objective"] = one_line(summary.objective);
  object["unit"] = one_line(summary.unit);
  object["ending"] = summary.ending && !is_running ? json(one_line(*summary.ending)) : json();
  std::optional<double> left;
  if (is_running && summary.runs == 1 && summary.made < summary.planned) {
    left = entry.speed.time_of(summary.planned - summary.made);
  }
  object["left_s"] = left ? json(*left) : json();
  // What was printed before the store was written last is of an earlier program.
  if (object["state"] == "interrupted" ||
      (object["state"] == "ended" && modified_ns(log_of(search)) > modified_ns(store_of(search)))) {
    object["problem"] = text_or_null(failure_of(search));
  }
  return object;
}

json SearchFolder::list(Clock::time_point now) {
  if (now >= next_walk_) {
    const auto begin = Clock::now();
    walk();
    next_walk_ = now + 50 * (Clock::now() - begin);  // at most 2 % of the time
  }
  struct Found {
    const std::string* name;
    Entry* entry;
    std::int64_t time_ns;
  };
  std::vector<Found> all;
  for (auto& [name, entry] : entries_) {
    all.push_back({&name, &entry, version_of(store_of(folder_ / name)).time_ns});
  }
  std::ranges::stable_sort(all, std::greater(), [](const Found& found) { return found.time_ns; });
  all.resize(std::min(all.size(), max_searches));
  json searches = json::array();
  has_unread_ = false;
  bool has_read_new = false;  // one at least: the list is complete some time, however busy the computer is
  const Clock::time_point end = Clock::now() + time_to_read;
  for (const auto& [name, entry, time_ns] : all) {
    const fs::path search = folder_ / *name;
    // In this order: what a program has written before its end is in the version of a search that does not run.
    const bool is_running = optimize::is_being_written(store_of(search));
    const Version version = version_of(store_of(search));
    if (version.inode == 0) {
      continue;  // it has gone since the last walk
    }
    const bool is_late = Clock::now() >= end && has_read_new;
    if (!entry->is_read && is_late) {
      has_unread_ = true;
    } else if (!entry->is_read || entry->version != version) {
      has_read_new = has_read_new || !entry->is_read;
      read(store_of(search), version, *entry);
    }
    if (is_running) {
      entry->speed.note(entry->summary.made, now);
    } else {
      entry->speed.forget();
    }
    searches.push_back(object_of(*name, search, *entry, is_running));
  }
  return searches;
}

fs::path SearchFolder::find(const std::string& name) const {
  const std::string expected = "the name of a search in " + folder_.filename().string();
  fs::path path = find_inside(folder_, name, "name", expected);
  std::error_code error;
  const fs::path store = fs::canonical(store_of(path), error);
  if (error || !fs::is_regular_file(store, error) || !is_inside(folder_, store)) {
    throw InputError("name", 0, in_quotes(one_line(shortened(name))), expected);
  }
  return path;
}

}  // namespace proleg::tools
