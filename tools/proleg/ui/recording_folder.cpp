#include "tools/proleg/ui/recording_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <set>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/recording_file.hpp"
#include "tools/proleg/ui/folder_walk.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What has to be read from the file.
json describe(const fs::path& path) {
  try {
    const sim::Recording recording(path);
    std::vector<std::string> algorithms;
    for (const sim::RecordedSlot& slot : recording.slots()) {
      if (std::ranges::find(algorithms, slot.algorithm) == algorithms.end()) {
        algorithms.push_back(slot.algorithm);
      }
    }
    return {{"program", recording.run_value("program")},
            {"scenario", fs::path(recording.run_value("scenario")).filename().string()},
            {"algorithms", algorithms},
            {"joints", recording.joints().size()},
            {"seconds", recording.time_s(recording.last_tick()) - recording.sync_time_s(recording.first_tick())},
            {"finished", recording.finished()},
            {"problem", nullptr}};
  } catch (const std::exception& error) {
    return {{"problem", one_line(error.what())}};
  }
}

}  // namespace

RecordingFolder::RecordingFolder(const fs::path& folder) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(folder_, error)) {
    throw InputError(folder.string(), 0, error ? error.message() : "no folder", "a folder with recordings");
  }
}

/// companions: names that were seen of the files beside recordings. Most recordings have none, and to look for each
/// would take most of the time of a list.
RecordingFolder::Version RecordingFolder::version_of(const fs::path& path, const std::set<std::string>& companions) {
  Version version;
  const auto add = [&version](const std::string& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) == 0) {
      version.size += static_cast<std::uint64_t>(status.st_size);
      constexpr std::int64_t second = 1'000'000'000;
      version.time_ns = std::max(version.time_ns, status.st_mtim.tv_sec * second + status.st_mtim.tv_nsec);
    }
  };
  add(path.string());
  // Of a growing recording the newest part is in a file beside it.
  for (const std::string& suffix : sim::recording_companions()) {
    if (const std::string companion = path.string() + suffix; companions.contains(companion)) {
      add(companion);
    }
  }
  return version;
}

json RecordingFolder::list() {
  std::vector<fs::path> recordings;
  std::set<std::string> companions;
  const auto enters_all = [](const fs::path& /*folder*/) { return true; };
  const auto note = [&](const fs::directory_entry& entry) {
    const fs::path& path = entry.path();
    std::error_code error;
    if (path.extension() != ".proleg") {
      if (path.native().find(".proleg-") != std::string::npos) {
        companions.insert(path.native());
      }
      return;
    }
    // What is no link is inside, as links to folders are not followed.
    const bool is_elsewhere =
        entry.is_symlink(error) && (!is_inside(folder_, fs::canonical(path, error)) || static_cast<bool>(error));
    if (!is_elsewhere && entry.is_regular_file(error)) {
      recordings.push_back(path);
    }
  };
  for_each_path(folder_, note, enters_all);
  std::map<std::string, Entry> found;
  for (const fs::path& path : recordings) {
    const std::string name = path.lexically_relative(folder_).string();
    Entry& known = found[name];
    known.version = version_of(path, companions);
    if (const auto before = entries_.find(name); before != entries_.end()) {
      known.description = std::move(before->second.description);
      known.is_described = before->second.is_described && before->second.version == known.version;
    }
  }
  std::vector<std::pair<std::int64_t, std::string>> newest;
  newest.reserve(found.size());
  for (const auto& [name, known] : found) {
    newest.emplace_back(-known.version.time_ns, name);
  }
  std::ranges::sort(newest);
  for (; newest.size() > max_files; newest.pop_back()) {
    found.erase(newest.back().second);
  }
  entries_ = std::move(found);
  undescribed_.clear();
  json files = json::array();
  for (const auto& [time, name] : newest) {
    const Entry& known = entries_.at(name);
    json file = known.description.is_null() ? json::object() : known.description;
    file["name"] = name;
    file["bytes"] = known.version.size;
    file["time_ms"] = known.version.time_ns / 1'000'000;
    file["described"] = !known.description.is_null();
    files.push_back(std::move(file));
    if (!known.is_described) {
      undescribed_.push_back(name);
    }
  }
  std::ranges::reverse(undescribed_);
  return files;
}

bool RecordingFolder::describe_some() {
  if (undescribed_.empty()) {
    return false;
  }
  const std::string name = std::move(undescribed_.back());
  undescribed_.pop_back();
  Entry& next = entries_.at(name);
  next.description = describe(folder_ / name);
  next.is_described = true;
  return true;
}

fs::path RecordingFolder::find(const std::string& name) const {
  const std::string expected = "the name of a recording in " + folder_.filename().string();
  if (fs::path(name).extension() != ".proleg") {
    throw InputError("file", 0, in_quotes(one_line(shortened(name))), expected);
  }
  return find_inside(folder_, name, "file", expected);
}

std::filesystem::path new_recording(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path file(name);
  if (file.empty() || file.filename() != file || file.extension() != ".proleg" || !is_visible_line(name)) {
    throw InputError("file", 0, in_quotes(one_line(name)),
                     "a name of visible characters without a folder that ends in .proleg");
  }
  std::filesystem::path path = folder / file;
  if (std::filesystem::exists(std::filesystem::symlink_status(path))) {
    throw InputError(path.string(), 0, "a file or a link that exists", "a new name");
  }
  return path;
}

}  // namespace proleg::tools
