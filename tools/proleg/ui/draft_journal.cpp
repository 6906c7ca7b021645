#include "tools/proleg/ui/draft_journal.hpp"

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int journal_format = 1;
constexpr std::size_t most_bytes = std::size_t{16} << 20U;  // what DiskFiles reads

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

bool is_running(pid_t process) { return process > 0 && (kill(process, 0) == 0 || errno == EPERM); }

/// Throws nlohmann::json::exception for another text.
KeptChanges changes_of(const json& document, const sim::Draft& draft) {
  KeptChanges changes;
  changes.time_ms = document.at("time_ms").get<std::int64_t>();
  std::map<std::string, std::string> saved;
  for (const sim::SourceFile& source : draft.scenario().sources) {
    saved.emplace(source.path, source.text);
  }
  for (const auto& [name, file] : document.at("files").items()) {
    const auto found = saved.find(name);
    const json& base = file.at("base");
    const bool is_as_it_was = base.is_null()
                                  ? found == saved.end()
                                  : found != saved.end() && base.get<std::string>() == sha256_hex(found->second);
    if (!is_as_it_was) {
      throw InputError(name, 0, "a file that has changed since", "the file to which the unsaved changes belong");
    }
    changes.texts.emplace(name, file.at("text").get<std::string>());
  }
  return changes;
}

}  // namespace

std::optional<KeptChanges> DraftJournal::read(const sim::Draft& draft) {
  sim::DiskFiles disk;
  const std::optional<std::string> text = disk.read(path_);
  if (!text) {
    return std::nullopt;
  }
  try {
    try {
      const json document = json::parse(*text);
      if (document.at("format") != journal_format) {
        throw InputError(path_.string(), 0, "changes in another format", "those of this version");
      }
      const json& written_by = document.at("process");
      if (!is_whole_number<pid_t>(written_by) || !is_whole_number<std::int64_t>(document.at("time_ms"))) {
        throw InputError(path_.string(), 0, "no unsaved changes", "a file that this program has written");
      }
      const auto process = written_by.get<pid_t>();
      if (process != getpid() && is_running(process)) {
        is_of_other_ = true;
        return std::nullopt;
      }
      KeptChanges changes = changes_of(document, draft);
      exists_ = true;
      has_kept_ = true;
      return changes;
    } catch (const json::exception&) {
      throw InputError(path_.string(), 0, "no unsaved changes", "a file that this program has written");
    }
  } catch (const InputError&) {
    put_aside();
    throw;
  }
}

void DraftJournal::put_aside() {
  std::error_code ignored;
  fs::rename(path_, path_.string() + ".old", ignored);
  exists_ = false;
  has_kept_ = false;
}

void DraftJournal::discard() {
  has_kept_ = false;
  if (std::exchange(exists_, false)) {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
}

void DraftJournal::note_change(Clock::time_point now) {
  if (!is_of_other_ && !due_) {
    due_ = now + delay;
  }
}

void DraftJournal::write(const sim::Draft& draft) {
  due_.reset();
  if (has_kept_) {
    put_aside();
  }
  const std::vector<sim::Draft::ChangedFile> changed = draft.changed_files();
  if (changed.empty()) {
    discard();
    return;
  }
  json files = json::object();
  std::size_t bytes = 0;
  for (const sim::Draft::ChangedFile& file : changed) {
    bytes += file.text.size();
    files[file.name] = {{"base", file.saved ? json(sha256_hex(*file.saved)) : json()}, {"text", file.text}};
  }
  try {
    if (bytes > most_bytes) {
      throw FileError(path_, "cannot keep unsaved changes of " + std::to_string(bytes >> 20U) + " MiB");
    }
    write_file(path_,
               json{{"format", journal_format}, {"process", getpid()}, {"time_ms", now_ms()}, {"files", files}}.dump());
    exists_ = true;
    has_failed_ = false;
  } catch (const FileError&) {
    if (!std::exchange(has_failed_, true)) {
      throw;
    }
  }
}

fs::path journal_path(const std::string& scenario, bool is_own_file, const fs::path& folder) {
  const fs::path path(scenario);
  const std::string name = "." + path.filename().string();
  constexpr std::size_t digits = 8;
  return is_own_file
             ? path.parent_path() / (name + ".unsaved")
             : folder / (name + "." + sha256_hex(fs::absolute(path).lexically_normal().string()).substr(0, digits) +
                         ".unsaved");
}

}  // namespace proleg::tools
