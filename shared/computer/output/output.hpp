#pragma once

#include <filesystem>
#include <string>
#include <string_view>

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

}  // namespace proleg
