#pragma once

// The folder (--out) into which a search, a sweep or an experiment writes its files.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace proleg::tools {

/// The folder of a search or a sweep, whose name is `what`: that of --resume, else that of --out, else the one with
/// this name. Throws BadInput for two different folders, InputError for an empty name.
[[nodiscard]] std::filesystem::path chosen_folder(const std::optional<std::string>& out,
                                                  const std::optional<std::string>& resume, const std::string& name,
                                                  const std::string& what);

/// Throws InputError if the folder cannot be made or written in, and BadInput if one of the files exists in it: results
/// replace only their own files. To be called before the work begins.
void check_result_folder(const std::filesystem::path& folder, std::span<const std::string_view> files);

/// Creates the folder. Throws BadInput.
void create_result_folder(const std::filesystem::path& folder);

/// A folder for results, created if there is none, which no other program can claim while this object exists. The end
/// removes it again if it was created and is still empty. The lock is on the folder itself (flock), so it ends with the
/// process; on a file system without such locks the folder is not locked.
class ResultFolder {
 public:
  /// Throws BadInput if another program has claimed the folder; otherwise as check_result_folder().
  ResultFolder(const std::filesystem::path& path, std::span<const std::string_view> files);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

 private:
  std::filesystem::path path_;
  bool is_new_;
  int descriptor_ = -1;
};

/// The name of a file that belongs to a recording: run.svg for run.proleg. Only the usual extension of recordings is
/// replaced, so that run.1 and run.2 do not share a file.
[[nodiscard]] inline std::filesystem::path beside_recording(const std::filesystem::path& recording,
                                                            const std::string& extension) {
  return recording.extension() == ".proleg" ? std::filesystem::path(recording).replace_extension(extension)
                                            : std::filesystem::path(recording.string() + extension);
}

}  // namespace proleg::tools
