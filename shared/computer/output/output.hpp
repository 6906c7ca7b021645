#pragma once

// The files into which programs write their results: how they are written, which existing files they may replace, and
// how they are read back.

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg {

/// The file that a path names: symbolic links are followed, also one to a file that does not exist yet. The folder is
/// canonical, so that equal results are one file. A path that cannot be followed is returned as it is.
[[nodiscard]] std::filesystem::path follow_links(const std::filesystem::path& path);

/// A name in a folder that no file of another program has. It is for a file that is renamed when it is complete. The
/// name does not depend on the final name, which may be as long as names can be.
[[nodiscard]] std::filesystem::path temporary_name(const std::filesystem::path& folder);

/// The file into which a tool writes its result. The file appears under its name only when it is complete: the data
/// goes into a file without a name, which ends with the process in any case; finish() gives it the name. It gets the
/// permissions of the file that it replaces. (On a file system without such files it is a temporary file, which a
/// signal can leave behind. An existing target that is not an ordinary file, such as a pipe or a device, is written
/// directly.)
class Output {
 public:
  /// Throws FileError if the file cannot be created.
  explicit Output(const std::filesystem::path& path);
  /// Writes to standard output.
  Output();
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// Throws FileError if the system refuses, ReaderGone if the program at the other end of a pipe has ended.
  void write(std::string_view text);
  /// Writes the rest and gives the file its name. Throws as write() does.
  void finish();

 private:
  void open_new_file();
  void flush();
  void write_now(std::string_view rest);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path path_;
  bool is_unnamed_ = false;
  std::filesystem::path temporary_;  ///< the name of the temporary file until finish(); empty if the file has no name
  int descriptor_;
  std::string buffer_;
};

/// Writes a whole file. Throws as Output does.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Exception: the program that reads standard output has ended. This is no error to report.
class ReaderGone {};

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

/// The bytes of a whole file. Throws FileError if the system refuses, also in the middle of the file.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// The first bytes of a file, at most `size`.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t size);

/// Whether a file starts with this text: the usual PlannedOutput::is_of_kind.
[[nodiscard]] std::function<bool(const std::filesystem::path&)> starts_with(std::string_view text);

}  // namespace proleg
