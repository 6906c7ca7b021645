#pragma once

// Unsaved changes of a draft on disk, in case the program ends before they are saved.

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/authoring/draft.hpp"

namespace proleg::tools {

/// The unsaved changes of an earlier program.
struct KeptChanges {
  std::int64_t time_ms = 0;                  ///< when they were written, since 1970
  std::map<std::string, std::string> texts;  ///< of the files that were changed, by name
};

/// A text that no other process has had or will have, not even one with the same number, also after a restart of the
/// computer. Empty if there is no such process.
[[nodiscard]] std::string process_identity(pid_t process);

class DraftJournal {
 public:
  using Clock = std::chrono::steady_clock;
  /// Changes are written so long after the first of them.
  static constexpr std::chrono::milliseconds delay{500};

  /// path: of the file with the changes.
  explicit DraftJournal(std::filesystem::path path) : path_(std::move(path)) {}

  /// What an earlier program has left for this draft. Throws InputError, which says why, if there is something that
  /// does not fit: the file is damaged, or the files of the draft have changed since. Then it is kept under another
  /// name. Nothing if there is none, or if another program that still runs uses it.
  [[nodiscard]] std::optional<KeptChanges> read(const sim::Draft& draft);
  /// Removes the file.
  void discard();
  /// What read() has found is in the draft now, or is not wanted: write() may replace it. Before that it keeps it under
  /// another name.
  void forget_kept() { has_kept_ = false; }

  /// The draft has changed, or was saved.
  void note_change(Clock::time_point now);
  /// When write() is due; nothing: there is nothing to write.
  [[nodiscard]] std::optional<Clock::time_point> due() const { return due_; }
  /// Writes the changes of the draft; removes the file if there are none. Throws FileError, once.
  void write(const sim::Draft& draft);

 private:
  void put_aside();

  std::filesystem::path path_;
  std::optional<Clock::time_point> due_;
  bool is_of_other_ = false;  ///< another program uses the file
  bool has_failed_ = false;
  bool exists_ = false;    ///< the file
  bool has_kept_ = false;  ///< the file has changes of an earlier program
};

/// The journal of the draft of a scenario: beside its top-level file; for one that is not the user's in the folder,
/// under a name that no other scenario has.
[[nodiscard]] std::filesystem::path journal_path(const std::string& scenario, bool is_own_file,
                                                 const std::filesystem::path& folder);

}  // namespace proleg::tools
