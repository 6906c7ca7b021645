#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg {

/// A file that a program is going to write.
struct PlannedOutput {
  std::string option;  ///< name for messages: "--record"
  std::filesystem::path path;
  std::string kind;  ///< kind of file that the program writes: "CAN log"
  /// Whether an existing file is of this kind, so that it may be replaced. Empty files may always be replaced.
  std::function<bool(const std::filesystem::path&)> is_of_kind;
  bool must_be_file = false;                 ///< whether the output cannot be a pipe or a device
  std::vector<std::string> companions = {};  ///< suffixes of files that are written beside it
};

/// Checks all files before the first is opened, so that a command that is refused changes none. The rule of all
/// programs: a file replaces a file of its own kind, and nothing else. Throws InputError for an existing file of
/// another kind, for a folder, for a file that cannot be created or written, and for two outputs that are one file,
/// whatever their names are.
void check_outputs(std::span<const PlannedOutput> outputs);

/// The first bytes of a file, at most `size`.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t size);

/// Whether a file starts with this text: the usual PlannedOutput::is_of_kind.
[[nodiscard]] std::function<bool(const std::filesystem::path&)> starts_with(std::string_view text);

}  // namespace proleg
