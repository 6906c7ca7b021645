#include "tools/proleg/ui/sweep_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "tools/proleg/ui/command_sequence.hpp"
#include "tools/proleg/ui/folder_walk.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* marks[] = {optimize::sweep_request_name, optimize::sweep_table_name};

}  // namespace

SweepFolder::SweepFolder(const fs::path& folder) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(folder_, error)) {
    throw InputError(folder.string(), 0, error ? error.message() : "no folder", "a folder with sweeps");
  }
}

fs::path SweepFolder::table_of(const fs::path& sweep) { return sweep / optimize::sweep_table_name; }
fs::path SweepFolder::request_of(const fs::path& sweep) { return sweep / optimize::sweep_request_name; }
fs::path SweepFolder::log_of(const fs::path& sweep) { return sweep / "sweep.log"; }

std::string SweepFolder::failure_of(const fs::path& sweep) {
  const std::string last = last_line_of_file(log_of(sweep));
  const bool is_failure = last.starts_with("proleg sweep: ") && last.find(": interrupted ") == std::string::npos &&
                          last.find(": warning: ") == std::string::npos &&
                          last.find("another program writes its results") == std::string::npos;
  return is_failure ? without_program_name(last) : std::string();
}

NotedSweep SweepFolder::note_of(const fs::path& sweep) {
  constexpr std::size_t most = 1 << 20;
  const fs::path file = request_of(sweep);
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw InputError(table_of(sweep).filename().string(), 0, "no file " + file.filename().string() + " beside it",
                     "one: the sweep is of an older version of Proleg; `proleg sweep --resume` writes it");
  }
  NotedSweep note{optimize::read_sweep_request(file.filename().string(), first_bytes(file, most)), {}};
  note.outline = optimize::sweep_without_scenario(note.request);
  if (!sim::find_measure(note.request.measure)) {
    throw InputError(file.filename().string(), 0, "the measure " + in_quotes(note.request.measure),
                     "a measure of this version");
  }
  return note;
}

SweepFolder::Version SweepFolder::version_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    return {};
  }
  constexpr std::int64_t second = 1'000'000'000;
  return {status.st_ino, static_cast<std::uint64_t>(status.st_size),
          status.st_mtim.tv_sec * second + status.st_mtim.tv_nsec};
}

void SweepFolder::walk() {
  std::vector<std::string> before;
  for (const auto& [name, entry] : entries_) {
    before.push_back(name);
  }
  std::map<std::string, Entry> found;
  for (const std::string& name : folders_with(folder_, marks, before)) {
    found[name] = std::move(entries_[name]);
  }
  entries_ = std::move(found);
}

void SweepFolder::read_request(const fs::path& sweep, Entry& entry) {
  const Version version = version_of(request_of(sweep));
  if (entry.request_version == version && version.inode != 0) {
    return;
  }
  entry.request_version = version;
  entry.problem.clear();
  try {
    entry.note = note_of(sweep);
  } catch (const std::exception& error) {
    entry.problem = one_line(error.what());
  }
}

void SweepFolder::count_lines(const fs::path& sweep, Entry& entry) {
  const Version version = version_of(table_of(sweep));
  if (version == entry.table_version) {
    return;
  }
  const bool has_grown = version.inode == entry.table_version.inode && version.size > entry.table_version.size;
  std::uint64_t at = has_grown ? entry.table_version.size : 0;
  entry.lines = has_grown ? entry.lines : 0;
  std::ifstream file(table_of(sweep), std::ios::binary);
  file.seekg(static_cast<std::streamoff>(at));
  std::array<char, 1 << 16> part{};
  while (at < version.size && file) {
    file.read(part.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(part.size(), version.size - at)));
    const auto read = file.gcount();
    entry.lines += static_cast<std::uint64_t>(std::count(part.begin(), part.begin() + read, '\n'));
    at += static_cast<std::uint64_t>(read);
  }
  entry.table_version = version;
}

json SweepFolder::object_of(const std::string& name, const fs::path& sweep, Entry& entry, Clock::time_point now) {
  read_request(sweep, entry);
  json object{{"name", name},
              {"state", "unreadable"},
              {"scenario", ""},
              {"started", ""},
              {"measure", ""},
              {"unit", ""},
              {"made", 0},
              {"planned", 0},
              {"left_s", json()},
              {"quantities", json::array()},
              {"problem", text_or_null(entry.problem)}};
  if (!entry.problem.empty()) {
    return object;
  }
  const bool is_running = optimize::is_being_written(table_of(sweep));
  count_lines(sweep, entry);
  const optimize::SweepRequest& request = entry.note.request;
  const std::uint64_t made = entry.lines - std::min<std::uint64_t>(entry.lines, optimize::sweep_head_lines);
  const std::uint64_t planned = entry.note.outline.size();
  object["state"] = is_running        ? optimize::is_stop_requested(table_of(sweep)) ? "stopping" : "running"
                    : made >= planned ? "ended"
                                      : "interrupted";
  object["scenario"] = one_line(fs::path(request.scenario).filename().string());
  object["started"] = one_line(request.started);
  object["measure"] = request.measure;
  object["unit"] = std::string(sim::declaration_of(*sim::find_measure(request.measure)).unit);
  object["made"] = made;
  object["planned"] = planned;
  for (const optimize::SweptQuantity& quantity : entry.note.outline.quantities) {
    object["quantities"].push_back(
        {{"name", one_line(quantity.name)}, {"unit", quantity.unit}, {"count", quantity.values.size()}});
  }
  if (is_running) {
    entry.speed.note(made, now);
    const std::optional<double> left = made < planned ? entry.speed.time_of(planned - made) : std::nullopt;
    object["left_s"] = left ? json(*left) : json();
  } else {
    entry.speed.forget();
    if (version_of(log_of(sweep)).time_ns >= entry.table_version.time_ns) {
      object["problem"] = text_or_null(failure_of(sweep));
    }
  }
  return object;
}

json SweepFolder::list(Clock::time_point now) {
  if (now >= next_walk_) {
    const auto begin = Clock::now();
    walk();
    next_walk_ = now + 50 * (Clock::now() - begin);  // at most 2 % of the time
  }
  std::vector<std::pair<std::int64_t, const std::string*>> all;
  for (const auto& [name, entry] : entries_) {
    const std::int64_t table = version_of(table_of(folder_ / name)).time_ns;
    const std::int64_t time_ns = std::max(table, version_of(request_of(folder_ / name)).time_ns);
    if (time_ns != 0) {  // else it has gone since the last walk
      all.emplace_back(time_ns, &name);
    }
  }
  std::ranges::stable_sort(all, std::greater(), &std::pair<std::int64_t, const std::string*>::first);
  all.resize(std::min(all.size(), max_sweeps));
  json sweeps = json::array();
  for (const auto& [time_ns, name] : all) {
    sweeps.push_back(object_of(*name, folder_ / *name, entries_[*name], now));
  }
  return sweeps;
}

fs::path SweepFolder::find(const std::string& name) const {
  const std::string expected = "the name of a sweep in " + folder_.filename().string();
  fs::path path = find_inside(folder_, name, "name", expected);
  for (const char* const mark : marks) {
    std::error_code error;
    const fs::path file = fs::canonical(path / mark, error);
    if (!error && fs::is_regular_file(file, error) && is_inside(folder_, file)) {
      return path;
    }
  }
  throw InputError("name", 0, in_quotes(one_line(shortened(name))), expected);
}

}  // namespace proleg::tools
