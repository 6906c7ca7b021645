#include "tools/proleg/ui/draft_journal.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int journal_format = 1;
constexpr std::size_t most_bytes = std::size_t{48}
                                   << 20U;  // more than a draft has, with files that undo would bring back

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// A file of the kernel, which has no size.
std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Whether the process with this identity still runs, and is not this one.
bool is_another_program(const std::string& identity) {
  const auto process = parse_whole<pid_t>(std::string_view(identity).substr(0, identity.find(' ')));
  return process && *process != getpid() && process_identity(*process) == identity;
}

/// Whether a file is in a folder that has a file of the draft, or below one.
bool is_beside(const fs::path& name, const sim::Draft& draft) {
  const fs::path path = name.lexically_normal();
  return std::ranges::any_of(draft.scenario().sources, [&path](const sim::SourceFile& source) {
    const fs::path folder = fs::path(source.path).lexically_normal().parent_path();
    const auto [differs, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    return differs == folder.end() && rest != path.end() && *rest != ".." && path.is_absolute() == folder.is_absolute();
  });
}

/// Throws nlohmann::json::exception for another text.
KeptChanges changes_of(const json& document, const sim::Draft& draft) {
  KeptChanges changes;
  changes.time_ms = document.at("time_ms").get<std::int64_t>();
  sim::DiskFiles disk;
  for (const auto& [name, file] : document.at("files").items()) {
    if (!is_beside(name, draft)) {
      throw InputError(name, 0, "a file that is not beside the scenario", "a file to which its changes belong");
    }
    // The draft may not name it now: a change that was undone has added it.
    std::optional<std::string> saved = draft.has(name) ? draft.text(name) : disk.read(name);
    if (saved) {
      saved = sim::source_text(std::move(*saved));
    }
    const json& base = file.at("base");
    if (base.is_null() ? saved.has_value() : !saved || base.get<std::string>() != sha256_hex(*saved)) {
      throw InputError(name, 0, "a file that has changed since", "the file to which the unsaved changes belong");
    }
    changes.texts.emplace(name, file.at("text").get<std::string>());
  }
  return changes;
}

/// A JSON object to which further members come.
std::string without_end(std::string object) {
  object.pop_back();
  return object;
}

}  // namespace

std::string process_identity(pid_t process) {
  const std::string state = contents("/proc/" + std::to_string(process) + "/stat");
  const std::vector<std::string_view> fields = words(std::string_view(state).substr(state.rfind(')') + 1));
  constexpr std::size_t start_time = 19;  // field 22, of which two stand before the name's end (proc(5))
  if (fields.size() <= start_time) {
    return {};
  }
  return std::to_string(process) + " " + std::string(fields[start_time]) + " " +
         std::string(trimmed(contents("/proc/sys/kernel/random/boot_id")));
}

std::optional<KeptChanges> DraftJournal::read(const sim::Draft& draft) {
  sim::DiskFiles disk(2 * most_bytes);  // with the names, and texts as JSON has them
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
      if (!is_whole_number<std::int64_t>(document.at("time_ms"))) {
        throw InputError(path_.string(), 0, "no unsaved changes", "a file that this program has written");
      }
      if (is_another_program(document.at("process").get<std::string>())) {
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
  std::size_t bytes = 0;
  for (const sim::Draft::ChangedFile& file : changed) {
    bytes += file.text.size();
  }
  try {
    if (bytes > most_bytes) {
      throw FileError(path_, "cannot keep unsaved changes of " + std::to_string(bytes >> 20U) + " MiB");
    }
    Output journal(path_);
    const json head{{"format", journal_format}, {"process", process_identity(getpid())}, {"time_ms", now_ms()}};
    journal.write(without_end(head.dump()));
    // One file after the other: meshes have megabytes.
    std::string_view before = R"(,"files":{)";
    for (const sim::Draft::ChangedFile& file : changed) {
      journal.write(before);
      journal.write(json(file.name).dump() + ":");
      journal.write(without_end(json{{"base", file.saved ? json(sha256_hex(*file.saved)) : json()}}.dump()));
      journal.write(R"(,"text":)");
      journal.write(json(file.text.str()).dump());
      journal.write("}");
      before = ",";
    }
    journal.write("}}\n");
    journal.finish();
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
